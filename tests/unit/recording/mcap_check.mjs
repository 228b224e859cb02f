// mcap_check.mjs PACKAGES FILE OUT: reads an MCAP file with @mcap/core, by its index and from front to back, decodes
// its messages with @foxglove/rosmsg2-serialization by the definitions in it, and writes them into another. Exit code
// 77 without the packages.
import { createRequire } from "node:module";
import { readFileSync, writeFileSync } from "node:fs";

const [folder, input, output] = process.argv.slice(2);
let mcap, serialization, rosmsg, fzstd;
try {
  const require = createRequire(folder + "/");
  mcap = require("@mcap/core");
  serialization = require("@foxglove/rosmsg2-serialization");
  rosmsg = require("@foxglove/rosmsg");
  fzstd = require("fzstd");
} catch (error) {
  console.log("missing package: " + error.message);
  process.exit(77);
}

function assert(condition, text) {
  if (!condition) throw new Error(text);
}

const decompressHandlers = {
  zstd: (buffer, size) => fzstd.decompress(buffer, new Uint8Array(Number(size))),
};
const bytes = readFileSync(input);
const readable = {
  size: async () => BigInt(bytes.length),
  read: async (offset, length) =>
    new Uint8Array(bytes.buffer, bytes.byteOffset + Number(offset), Number(length)),
};
const reader = await mcap.McapIndexedReader.Initialize({ readable, decompressHandlers });
assert(reader.header.profile === "ros2", "profile " + reader.header.profile);
assert(reader.statistics.messageCount === 61n, "messages " + reader.statistics.messageCount);

const writable = {
  parts: [],
  length: 0n,
  async write(part) {
    this.parts.push(Buffer.from(part));
    this.length += BigInt(part.length);
  },
  position() {
    return this.length;
  },
};
const out = new mcap.McapWriter({ writable, useChunks: true });
await out.start({ profile: "ros2", library: "mcap_check" });
const channels = new Map();
const readers = new Map();
const counts = {};
for await (const message of reader.readMessages()) {
  const channel = reader.channelsById.get(message.channelId);
  const schema = reader.schemasById.get(channel.schemaId);
  if (!channels.has(channel.id)) {
    assert(schema.encoding === "ros2msg", schema.encoding);
    const definition = rosmsg.parse(new TextDecoder().decode(schema.data), { ros2: true });
    readers.set(channel.id, new serialization.MessageReader(definition));
    const schemaId = await out.registerSchema({ name: schema.name, encoding: schema.encoding, data: schema.data });
    channels.set(
      channel.id,
      await out.registerChannel({
        schemaId,
        topic: channel.topic,
        messageEncoding: channel.messageEncoding,
        metadata: channel.metadata,
      }),
    );
  }
  const decoded = readers.get(channel.id).readMessage(message.data);
  counts[channel.topic] = (counts[channel.topic] ?? 0) + 1;
  if (channel.topic === "/scan") {
    assert(decoded.ranges.length === 7, "ranges " + decoded.ranges.length);
    assert(decoded.angle_min === -0.75 && decoded.ranges[6] === Infinity, "scan");
    assert(decoded.header.frame_id === "laser", decoded.header.frame_id);
  }
  if (channel.topic === "/tf_static") {
    assert(decoded.transforms[0].transform.translation.x === 0.2, "mounting");
  }
  await out.addMessage({ ...message, channelId: channels.get(channel.id) });
}
await out.end();
assert(JSON.stringify(Object.entries(counts).sort()) === '[["/odom",20],["/scan",20],["/tf",20],["/tf_static",1]]',
  JSON.stringify(counts));
writeFileSync(output, Buffer.concat(writable.parts));

// Reads it from front to back, too, and validates the checksums of chunks.
const stream = new mcap.McapStreamReader({ decompressHandlers, validateCrcs: true });
stream.append(bytes);
let messages = 0;
for (let record; (record = stream.nextRecord()); ) {
  if (record.type === "Message") ++messages;
}
assert(messages === 61, "streamed " + messages);
