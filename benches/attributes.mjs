// Speed with normals and texture coordinates: the whole call, in turn with meshoptimizer's `simplifyWithAttributes`.
import { peerWithAttributes, simplifyOurs } from './support/engines.mjs';
import { benchModel } from './support/models.mjs';
import { atMost, printGoals, printTable, shown } from './support/report.mjs';
import { geometricMean, median, timeTogether } from './support/statistics.mjs';

const MODELS = ['stanford-bunny', 'igea'];
const RATIOS = [0.5, 0.1, 0.01];

/** Time as a share of the peer's with the same five numbers a vertex. */
const TIME_LIMIT = 1.2;

/** Runs the bench, prints its table and returns everything for `--json`. */
export function attributes({ presets, quick }) {
  const cases = [];
  for (const model of quick ? MODELS.slice(0, 1) : MODELS) {
    const mesh = shaded(benchModel(model));
    const numbers = interleaved(mesh.attributes);
    for (const ratio of RATIOS) {
      const target = Math.floor((mesh.indices.length / 3) * ratio);
      const jobs = [
        () => peerWithAttributes(mesh, numbers, target).indices,
        ...presets.map(({ options }) => () => simplifyOurs(mesh, target, options).indices),
      ];
      const [peer, ...ours] = timeTogether(jobs, { seconds: 8 });
      const shares = ours.map((times) => median(times.map((time, round) => time / peer[round])));
      cases.push({ model, ratio, rounds: peer.length, peer: median(peer), ours: ours.map(median), shares });
    }
    console.error(`attributes: ${model} done`);
  }
  printTable('attributes: milliseconds with normals and texture coordinates, medians, and as a share of simplifyWithAttributes',
    ['case', 'rounds', 'peer', ...presets.flatMap(({ name }) => [name, 'share'])],
    cases.map(({ model, ratio, rounds, peer, ours, shares }) => [
      `${model} ${ratio * 100} %`, String(rounds), shown(peer, 1), ...ours.flatMap((time, at) => [shown(time, 1), shown(shares[at], 2)]),
    ]));
  const goals = presets.map(({ name }, at) => atMost(`${name}, normals and texture coordinates: time / simplifyWithAttributes`,
    geometricMean(cases.map(({ shares }) => shares[at])), TIME_LIMIT));
  printGoals('attributes: what must hold', goals);
  return { cases, goals };
}

/** The mesh with smooth normals, and texture coordinates projected along z. */
function shaded({ positions, indices }) {
  const normal = new Float32Array(positions.length);
  for (let at = 0; at < indices.length; at += 3) {
    const [a, b, c] = [0, 1, 2].map((k) => positions.subarray(3 * indices[at + k], 3 * indices[at + k] + 3));
    const area = [0, 1, 2].map((k) => {
      const [i, j] = [(k + 1) % 3, (k + 2) % 3];
      return (b[i] - a[i]) * (c[j] - a[j]) - (b[j] - a[j]) * (c[i] - a[i]);
    });
    for (let k = 0; k < 9; k += 1) normal[3 * indices[at + Math.floor(k / 3)] + (k % 3)] += area[k % 3];
  }
  const [low, high] = [[Infinity, Infinity], [-Infinity, -Infinity]];
  for (let at = 0; at < positions.length; at += 3) {
    const length = Math.hypot(normal[at], normal[at + 1], normal[at + 2]) || 1;
    for (let k = 0; k < 3; k += 1) normal[at + k] /= length;
    for (let k = 0; k < 2; k += 1) {
      low[k] = Math.min(low[k], positions[at + k]);
      high[k] = Math.max(high[k], positions[at + k]);
    }
  }
  const extent = Math.max(high[0] - low[0], high[1] - low[1]);
  const uv = Float32Array.from({ length: (positions.length / 3) * 2 }, (_, at) =>
    (positions[3 * Math.floor(at / 2) + (at % 2)] - low[at % 2]) / extent);
  return { positions, indices, attributes: { normal, uv } };
}

/** Five numbers a vertex, as the peer wants them; made before the clock runs. */
function interleaved({ normal, uv }) {
  const numbers = new Float32Array((normal.length / 3) * 5);
  for (let v = 0; v < normal.length / 3; v += 1) {
    numbers.set(normal.subarray(3 * v, 3 * v + 3), 5 * v);
    numbers.set(uv.subarray(2 * v, 2 * v + 2), 5 * v + 3);
  }
  return numbers;
}
