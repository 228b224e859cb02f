// A made-up drive round a corridor as a CARMEN log, more than one round, so that loops close. Metres, radians; the same
// bytes each time.
const kOuter = [0, 0, 12, 9];
const kBoxes = [[2, 2, 10, 7], [0, 4, 0.5, 4.6], [6, 0, 6.4, 0.5], [11.3, 5, 12, 6], [8, 8.5, 9, 9], [3, 8.7, 3.3, 9]];
const kBeams = 181;
const kRange_m = 20;
const kStep_m = 0.1;
const kDrift = 0.01; // of the odometry, radians a metre

// Without furniture the corridor looks much the same from its other end.
const kFurniture = [[4, 0, 5, 0.5], [9.2, 0, 10.3, 0.3], [11.5, 2, 12, 2.5], [5, 8.5, 6.5, 9], [0, 6, 0.3, 7.6], [2, 7, 4.5, 7.4]];

function walls({ scale, furnished }) {
  const boxes = [kOuter, ...kBoxes, ...(furnished ? kFurniture : [])].map((box) => box.map((value) => scale * value));
  return boxes.flatMap(([x0, y0, x1, y1]) => [
    [x0, y0, x1, y0],
    [x1, y0, x1, y1],
    [x1, y1, x0, y1],
    [x0, y1, x0, y0],
  ]);
}

/** Distance from a point to the next wall in a direction. */
function cast(x, y, angle, lines) {
  const [dx, dy] = [Math.cos(angle), Math.sin(angle)];
  let nearest = kRange_m;
  for (const [ax, ay, bx, by] of lines) {
    const [ex, ey] = [bx - ax, by - ay];
    const across = dx * ey - dy * ex;
    if (Math.abs(across) < 1e-12) continue;
    const along = ((ax - x) * ey - (ay - y) * ex) / across;
    const share = ((ax - x) * dy - (ay - y) * dx) / across;
    if (along > 0 && share >= 0 && share <= 1) nearest = Math.min(nearest, along);
  }
  return nearest;
}

/** True poses: along the middle of the corridor, turning on the spot at its corners. */
function path(corners, { first, scale }) {
  const track = [[1, 1], [11, 1], [11, 8], [1, 8]].map((corner) => corner.map((value) => scale * value));
  const poses = [];
  let heading = (first * Math.PI) / 2;
  for (let i = first; i < first + corners; ++i) {
    const [from, to] = [track[i % 4], track[(i + 1) % 4]];
    const length = Math.hypot(to[0] - from[0], to[1] - from[1]);
    for (let s = 0; s < length; s += kStep_m) {
      const share = s / length;
      poses.push([from[0] + share * (to[0] - from[0]), from[1] + share * (to[1] - from[1]), heading]);
    }
    for (let turn = 0; turn < 6; ++turn) poses.push([...to, heading + ((turn + 1) * Math.PI) / 12]);
    heading += Math.PI / 2;
  }
  return poses;
}

/**
 * corners: number of sides that are driven; four are one round. first: the side where it begins. scale: of the
 * whole building.
 */
export function drive_log(corners, { first = 0, scale = 1, furnished = false } = {}) {
  const lines = walls({ scale, furnished });
  const number = (value) => value.toFixed(4);
  let [odom_x, odom_y, odom_theta] = [0, 0, 0];
  let before = null;
  return path(corners, { first, scale })
    .map(([x, y, theta], i) => {
      if (before) {
        const [dx, dy] = [x - before[0], y - before[1]];
        const step = Math.hypot(dx, dy);
        odom_theta += theta - before[2] + kDrift * step;
        odom_x += step * Math.cos(odom_theta);
        odom_y += step * Math.sin(odom_theta);
      }
      before = [x, y, theta];
      const ranges = Array.from({ length: kBeams }, (_, beam) =>
        number(cast(x, y, theta - Math.PI / 2 + (beam * Math.PI) / (kBeams - 1), lines)),
      );
      const odometry = [odom_x, odom_y, odom_theta].map(number).join(" ");
      const stamp = number(i * 0.4);
      return `FLASER ${kBeams} ${ranges.join(" ")} ${odometry} ${odometry} ${stamp} test ${stamp}\n`;
    })
    .join("");
}
