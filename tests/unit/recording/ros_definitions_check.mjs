// ros_definitions_check.mjs PACKAGES FILE: decodes messages with @foxglove/rosmsg2-serialization by the definitions of
// ROS Humble and Jazzy (@foxglove/rosmsg-msgs-common) and compares each field with the written one. FILE has one JSON
// line each: {type, bytes (hexadecimal), fields}. Prints types that a package lacks. Exit code 77 without the packages.
import { createRequire } from "node:module";
import { readFileSync } from "node:fs";
import { deepStrictEqual } from "node:assert";

const [folder, input] = process.argv.slice(2);
let serialization, common;
try {
  const require = createRequire(folder + "/");
  serialization = require("@foxglove/rosmsg2-serialization");
  common = require("@foxglove/rosmsg-msgs-common");
} catch (error) {
  console.log("missing package: " + error.message);
  process.exit(77);
}

// Types that the packages lack, copied from ros-planning/navigation_msgs.
const ADDED = {
  "map_msgs/OccupancyGridUpdate": {
    name: "map_msgs/OccupancyGridUpdate",
    definitions: [
      { name: "header", type: "std_msgs/Header", isComplex: true },
      { name: "x", type: "int32" },
      { name: "y", type: "int32" },
      { name: "width", type: "uint32" },
      { name: "height", type: "uint32" },
      { name: "data", type: "int8", isArray: true },
    ],
  },
};

// Converts decoded values: times are {sec, nsec}, and numbers may be in typed arrays.
function plain(value) {
  if (ArrayBuffer.isView(value)) return Array.from(value);
  if (Array.isArray(value)) return value.map(plain);
  if (typeof value !== "object") return value;
  if ("nsec" in value) return { sec: value.sec, nanosec: value.nsec };
  return Object.fromEntries(Object.entries(value).map(([name, inner]) => [name, plain(inner)]));
}

const messages = readFileSync(input, "utf8").trim().split("\n").map((line) => JSON.parse(line));
let compared = 0;
for (const release of ["ros2humble", "ros2jazzy"]) {
  const known = common[release];
  for (const { type, bytes, fields } of messages) {
    let root = known[type];
    if (root === undefined) {
      console.log(`${release} lacks ${type}`);
      root = ADDED[type];
    }
    const others = Object.values(known).filter((definition) => definition.name !== type);
    const reader = new serialization.MessageReader([root, ...others]);
    deepStrictEqual(plain(reader.readMessage(Buffer.from(bytes, "hex"))), fields, `${release} ${type}`);
    ++compared;
  }
}
console.log(`${compared} messages are as they were written`);
