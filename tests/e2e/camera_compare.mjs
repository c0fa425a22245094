// What the page sent (a file of MAROTTE_TRACE) beside the landmarks that the file of the webcam is
// known to have: the nearest of its frames, laid upon it, point by point.
//   node camera_compare.mjs TRACE FRAMES.json
import {readFileSync} from 'node:fs';

const [trace, file] = process.argv.slice(2);
const known = JSON.parse(readFileSync(file)).filter((frame) => frame.length === 21);

function centred(points) {
  const middle = [0, 1, 2].map((k) => points.reduce((sum, p) => sum + p[k], 0) / points.length);
  return points.map((p) => p.map((x, k) => x - middle[k]));
}

// Both are of one camera: what is left beside the place is the size, and hardly a turn.
function apart(a, b) {
  const [x, y] = [centred(a), centred(b)];
  const square = (p, q) => p.reduce((sum, at, i) => sum + at.reduce((s, v, k) => s + v * q[i][k], 0), 0);
  const scale = square(x, y) / square(x, x);
  return x.map((p, i) => Math.hypot(...p.map((v, k) => scale * v - y[i][k])) * 1000);
}

let frames = 0, hands = 0;
const distances = [];
for (const line of readFileSync(trace, 'utf8').trim().split('\n')) {
  const bytes = Buffer.from(line.split('<')[1].replace(/ /g, ''), 'hex');
  if (bytes[0] !== 1) continue;
  frames += 1;
  if (bytes[13] === 0) continue;
  hands += 1;
  const points = Array.from({length: 21}, (_, i) =>
    [0, 1, 2].map((k) => bytes.readFloatLE(19 + 12 * i + 4 * k)));
  const best = known.map((frame) => apart(points, frame))
    .reduce((a, b) => (a.reduce((s, v) => s + v) <= b.reduce((s, v) => s + v) ? a : b));
  distances.push(...best);
}
distances.sort((a, b) => a - b);
console.log(`frames ${frames}`);
console.log(`hands ${hands}`);
console.log(`share ${(100 * hands / Math.max(frames, 1)).toFixed(1)}`);
console.log(`median_mm ${(distances[distances.length >> 1] ?? NaN).toFixed(2)}`);
