// Quality: measured deviation and validity against meshoptimizer, MeshLab and the records of CGAL, six models.
import { cached } from './support/cache.mjs';
import * as deviation from './support/deviation.mjs';
import { peerHalving, peerSimplify, peerUpdate, peerVersion, simplifyOurs } from './support/engines.mjs';
import * as meshlab from './support/meshlab.mjs';
import { loadModel, sixModels } from './support/models.mjs';
import { lindstromTurkMeans, lowestMaxima } from './support/records.mjs';
import { atMost, none, printGoals, printTable, shown } from './support/report.mjs';
import { geometricMean, ratio } from './support/statistics.mjs';

/** Shares of the triangles that the geometric means are over. */
const RATIOS = [0.1, 0.02, 0.005];
/** Where CGAL's records are. */
const RECORD_RATIOS = [0.1, 0.01];
/** Where results with locked borders are looked at. */
const LOCKED_RATIOS = [0.5, 0.1];

/** Limits by preset, as a share of the peer's figure. */
const RMS_LIMIT = { fast: 0.55, balanced: 0.4, best: 0.34 };
const UPDATE_LIMIT = 0.74;
const MAXIMUM_LIMIT = 0.65;
const RECORD_LIMIT = { balanced: 1.05, best: 1 };
const BORDER_LIMIT = 0.001;

/** Faults that a result must have none of, non-manifold edges none more than its original; named as the meter does. */
const FAULTS = ['nonmanifold', 'dupfaces', 'degenerate', 'flipped'];

const PEERS = [
  { name: 'simplify', version: peerVersion, run: peerSimplify },
  { name: 'update', version: peerVersion, run: peerUpdate },
  { name: 'halving', version: peerVersion, run: peerHalving },
  ...(meshlab.version ? [{ name: 'meshlab', version: meshlab.version, run: meshlab.meshlabSimplify }] : []),
];

/** Runs the bench, prints its tables and returns everything for `--json`. */
export function quality({ presets, quick }) {
  if (!deviation.available) {
    console.log('quality: SKIPPED: no meter; MESHDIST may name one');
    return { skipped: 'no meter' };
  }
  if (!meshlab.version) console.log('MeshLab is left out: PYMESHLAB may name a virtual environment with pymeshlab');
  const names = quick ? ['stanford-bunny', 'fandisk'] : sixModels;
  const cases = [];
  for (const name of names) {
    const mesh = loadModel(name);
    const original = deviation.measure(mesh, mesh);
    for (const share of [...new Set([...RATIOS, ...RECORD_RATIOS])]) {
      cases.push(runCase(name, mesh, original, share, presets));
    }
    for (const share of quick || original.boundary === 0 ? [] : LOCKED_RATIOS) {
      cases.push(runCase(name, mesh, original, share, presets, true));
    }
    console.error(`quality: ${name} done`);
  }
  const means = presets.map((preset) => meansOf(preset, cases));
  const goals = presets.flatMap((preset, at) => goalsOf(preset, cases, means[at]));
  print(presets, cases, means);
  printGoals('quality: what must hold', goals);
  return { peers: PEERS.map(({ name, version }) => ({ name, version })), cases, means, goals };
}

/** One model at one share of its triangles, ours by preset beside the peers. Locked borders have no peers here. */
function runCase(model, mesh, original, share, presets, locked = false) {
  const target = Math.floor((mesh.indices.length / 3) * share + 1e-6);
  const figures = {};
  for (const { name, version, run } of locked ? [] : PEERS) {
    const key = deviation.resultKey(mesh, 'peer', name, version, String(target));
    figures[name] = cached(key, () => deviation.measure(mesh, run(mesh, target)));
  }
  for (const { name, options } of presets) {
    const lock = locked ? { lockBorder: true } : {};
    figures[name] = deviation.measure(mesh, simplifyOurs(mesh, target, { ...options, ...lock }));
  }
  return { model, share, target, locked, original, figures };
}

const counted = (cases) => cases.filter(({ share, locked }) => !locked && RATIOS.includes(share));
const against = (cases, mine, peer, key) => cases.map(({ figures }) => ratio(figures[mine]?.[key], figures[peer]?.[key]));

function meansOf({ name }, cases) {
  const rows = counted(cases);
  const bestUpdate = rows.map(({ figures }) =>
    ratio(figures[name].rms, Math.min(figures.update.rms, figures.halving.rms)),
  );
  return {
    preset: name,
    rms: geometricMean(against(rows, name, 'simplify', 'rms')),
    mean: geometricMean(against(rows, name, 'simplify', 'mean')),
    max: geometricMean(against(rows, name, 'simplify', 'haus')),
    rmsOfUpdate: geometricMean(against(rows, name, 'update', 'rms')),
    rmsOfHalving: geometricMean(against(rows, name, 'halving', 'rms')),
    rmsOfBetterUpdate: geometricMean(bestUpdate),
    rmsOfMeshlab: geometricMean(against(rows, name, 'meshlab', 'rms')),
    maxOfMeshlab: geometricMean(against(rows, name, 'meshlab', 'haus')),
  };
}

function goalsOf({ name, preset }, cases, means) {
  const rows = counted(cases);
  const label = (row) => `${row.model} ${row.share * 100} %${row.locked ? ' locked' : ''}`;
  const worse = (peer, key) =>
    rows
      .filter(({ figures }) => figures[peer] && figures[name][key] > figures[peer][key])
      .map((row) => `${label(row)} ${shown(row.figures[name][key] / row.figures[peer][key])}`);
  const goals = [atMost(`${name}: rms / simplify`, means.rms, RMS_LIMIT[preset])];
  if (preset === 'balanced') {
    goals.push(atMost(`${name}: rms / the better update`, means.rmsOfBetterUpdate, UPDATE_LIMIT));
    goals.push(atMost(`${name}: maximum / simplify`, means.max, MAXIMUM_LIMIT));
  }
  goals.push(none(`${name}: rms worse than simplify`, worse('simplify', 'rms'), rows.length));
  goals.push(none(`${name}: maximum worse than simplify`, worse('simplify', 'haus'), rows.length));
  const withMeshlab = meshlab.version ? rows.length : 0;
  goals.push(none(`${name}: rms worse than MeshLab`, worse('meshlab', 'rms'), withMeshlab));
  goals.push(none(`${name}: maximum worse than MeshLab`, worse('meshlab', 'haus'), withMeshlab));
  if (RECORD_LIMIT[preset]) {
    const limit = RECORD_LIMIT[preset];
    const recorded = cases.filter(({ share, locked }) => !locked && RECORD_RATIOS.includes(share));
    const above = recorded.map((row) => [row, row.figures[name].mean / lindstromTurkMeans[row.model][row.share]]);
    const failed = above.filter(([, value]) => value > limit).map(([row, value]) => `${label(row)} ${shown(value)}`);
    goals.push(none(`${name}: mean above ${limit} × CGAL's record`, failed, recorded.length));
  }
  return [...goals, ...validityGoals(name, cases, label)];
}

function validityGoals(name, cases, label) {
  const goals = FAULTS.map((fault) => {
    // A scan may bring non-manifold edges of its own: new ones are those above that number.
    const limit = ({ original }) => (fault === 'nonmanifold' ? original[fault] : 0);
    const failed = cases.filter((row) => row.figures[name][fault] > limit(row));
    return none(`${name}: ${fault}`, failed.map((row) => `${label(row)}: ${row.figures[name][fault]}`), cases.length);
  });
  const closed = cases.filter(({ original }) => original.boundary === 0 && original.nonmanifold === 0);
  const changed = closed.filter(({ original, figures: { [name]: after } }) =>
    after.boundary > 0 || after.nonmanifold > 0 || after.euler !== original.euler);
  goals.push(none(`${name}: closed manifold not kept`, changed.map(label), closed.length));
  const locked = cases.filter((row) => row.locked);
  const moved = locked.filter(({ original, figures }) =>
    Math.abs(figures[name].borderLength / original.borderLength - 1) > BORDER_LIMIT);
  goals.push(none(`${name}: locked border changed by over 0.1 %`, moved.map(label), locked.length));
  return goals;
}

function print(presets, cases, means) {
  const who = [...presets.map(({ name }) => name), ...PEERS.map(({ name }) => name)];
  const rows = cases.filter(({ locked }) => !locked);
  const tableRows = rows.flatMap(({ model, target, figures }) =>
    who.map((name) => {
      const mine = figures[name];
      const share = (key) => shown(ratio(mine[key], figures.simplify[key]));
      return [`${model} ${target}`, name, String(mine.triangles), shown(mine.mean, 5), shown(mine.rms, 5),
        shown(mine.haus, 4), share('rms'), share('haus'), shown(mine.nang_deg, 2)];
    }));
  printTable("quality: deviation in % of the diagonal, and as a share of simplify's",
    ['case', 'engine', 'triangles', 'mean', 'rms', 'max', 'rms/p', 'max/p', 'normal°'], tableRows);
  const validity = cases.flatMap(({ model, target, locked, original, figures }) =>
    ['original', ...who].filter((name) => name === 'original' || figures[name]).map((name) => {
      const at = name === 'original' ? original : figures[name];
      const counts = ['nonmanifold', 'inconsistent', 'degenerate', 'dupfaces', 'flipped', 'folds', 'slivers', 'euler'];
      const border = original.boundary === 0 && at.boundary === 0 ? '–' : shown(ratio(at.borderLength, original.borderLength), 4);
      return [`${model} ${target}${locked ? ' locked' : ''}`, name, ...counts.map((key) => String(at[key])),
        String(at.boundary), border];
    }));
  printTable('quality: validity (border length as a share of the original)',
    ['case', 'engine', 'nonman', 'incons', 'degen', 'dup', 'flipped', 'folds', 'slivers', 'euler', 'border', 'length'], validity);
  printRecords(presets, rows);
  printTable('quality: geometric means over 10, 2 and 0.5 %',
    ['preset', 'rms/simplify', 'mean/simplify', 'max/simplify', 'rms/update', 'rms/halving', 'rms/better', 'rms/meshlab', 'max/meshlab'],
    means.map(({ preset, ...values }) =>
      [preset, ...['rms', 'mean', 'max', 'rmsOfUpdate', 'rmsOfHalving', 'rmsOfBetterUpdate', 'rmsOfMeshlab', 'maxOfMeshlab']
        .map((key) => shown(values[key]))]));
}

function printRecords(presets, cases) {
  const rows = cases.filter(({ share }) => RECORD_RATIOS.includes(share)).map(({ model, share, figures }) => {
    const record = lindstromTurkMeans[model][share];
    const maximum = share === 0.1 ? lowestMaxima[model] : undefined;
    return [`${model} ${share * 100} %`, shown(record, 5),
      ...presets.flatMap(({ name }) => [shown(figures[name].mean, 5), shown(figures[name].mean / record)]),
      shown(maximum), ...presets.map(({ name }) => shown(ratio(figures[name].haus, maximum)))];
  });
  printTable("quality: mean against the records of CGAL's Lindstrom–Turk, maximum against the field's lowest",
    ['case', 'record', ...presets.flatMap(({ name }) => [name, '/record']), 'max', ...presets.map(({ name }) => `${name}/max`)], rows);
}
