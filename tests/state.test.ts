// The page's transitions and scales, without a browser.
import { describe, expect, it } from 'vitest';
import { formatBytes, formatLength, formatShare } from '../www/format.ts';
import { positionOfTriangles, trianglesAtPosition } from '../www/components/lod-slider/scale.ts';
import { writeOptions } from '../www/encoding.ts';
import * as transitions from '../www/state.ts';
import { statusText } from '../www/status.ts';
import type { State } from '../www/state.ts';

const source = { format: 'glb', compression: 'none' as const, bytes: 5000, triangles: 1000, vertices: 500, meshes: 1, diagonal: 2 };
const NOTHING = { seam: 0, corner: 0, border: 0, nonManifold: 0, locked: 0, topology: 0, flip: 0, error: 0, other: 0 };
const opened = (): State =>
  transitions.modelOpened(transitions.initialState, { name: 'vase', credit: '', source, warnings: [], animations: [] });
const ready = (fewest = 4): State => transitions.historyReady(transitions.modelDrawn(opened()), fewest);
const wanted = (state: State): number | undefined => state.model?.wantedTriangles;

describe('opening', () => {
  it('starts at full detail', () => {
    expect(opened().model).toMatchObject({ history: { kind: 'recording', fraction: 0 }, wantedTriangles: 1000, shown: { triangles: 1000, estimatedError: 0 } });
  });

  it('keeps the model when another file fails', () => {
    const opening = transitions.taskStarted(ready(), { kind: 'opening', name: 'bad.glb', fraction: null });
    const after = transitions.failed(opening, { code: 'truncated', message: 'ends early', where: 'byte 12' });
    expect(after.task).toBeNull();
    expect(after.model).toBe(opening.model);
    expect(after.notice?.code).toBe('truncated');
    expect(transitions.noticeDismissed(after).notice).toBeNull();
  });

  it('clears the last notice when something is tried again', () => {
    const after = transitions.failed(opened(), { code: 'x', message: '', where: '' });
    expect(transitions.taskStarted(after, { kind: 'opening', name: 'a', fraction: null }).notice).toBeNull();
  });

  it('forgets the undo steps of the model before', () => {
    const moved = transitions.targetMoved(ready(), 100, 1);
    const again = transitions.modelOpened(moved, { name: 'b', credit: '', source, warnings: [], animations: [] });
    expect(again.model?.undo).toEqual([]);
  });
});

describe('the compression to save with', () => {
  it('is that of the model, and nothing for a format without', () => {
    const packed = transitions.modelOpened(transitions.initialState, { name: 'a', credit: '', source: { ...source, compression: 'draco' }, warnings: [], animations: [] });
    expect(packed.encoding).toBe('draco');
    expect(writeOptions('glb', packed.encoding)).toEqual({ format: 'glb', compress: 'draco' });
    expect(writeOptions('obj', packed.encoding)).toEqual({ format: 'obj', compress: 'none' });
    expect(writeOptions('glb', transitions.encodingChosen(packed, 'meshopt-quantized').encoding)).toEqual({ format: 'glb', compress: 'meshopt', quantize: true });
  });
});

describe('the format to save', () => {
  const open = (state: State, format: string): State =>
    transitions.modelOpened(state, { name: 'a', credit: '', source: { ...source, format }, warnings: [], animations: [] });

  it('is that of the model, and GLB for what cannot be written', () => {
    expect(['ply', 'stl', 'obj', 'off', 'smf', 'glb', 'gltf'].map((format) => open(transitions.initialState, format).outputFormat)).toEqual(
      ['ply', 'stl', 'obj', 'off', 'smf', 'glb', 'glb'],
    );
  });

  it('is what was chosen until the next model', () => {
    const chosen = transitions.outputFormatChosen(open(transitions.initialState, 'stl'), 'ply');
    expect(chosen.outputFormat).toBe('ply');
    expect(open(chosen, 'obj').outputFormat).toBe('obj');
  });
});

describe('the slider', () => {
  it('stays between the fewest and all triangles', () => {
    expect(wanted(transitions.targetMoved(ready(4), 0, 1))).toBe(4);
    expect(wanted(transitions.targetMoved(transitions.targetMoved(ready(4), 10, 1), 5000, 2))).toBe(1000);
  });

  it('rounds, and ignores what is no number', () => {
    expect(wanted(transitions.targetMoved(ready(), 99.6, 1))).toBe(100);
    expect(wanted(transitions.targetMoved(ready(), Number.NaN, 1))).toBe(1000);
  });

  it('may move before the history is ready, and is held to what the history can do', () => {
    const early = transitions.targetMoved(opened(), 2, 1);
    expect(wanted(early)).toBe(2);
    expect(wanted(transitions.historyReady(early, 12))).toBe(12);
  });

  it('does nothing without a model', () => {
    expect(transitions.targetMoved(transitions.initialState, 5, 1)).toBe(transitions.initialState);
    expect(transitions.undone(transitions.initialState)).toBe(transitions.initialState);
  });
});

describe('measuring', () => {
  const deviation = { max: 0.4, mean: 0.1, rms: 0.2, relativeTo: 2 };
  const shown = (): State =>
    transitions.levelShown(transitions.targetMoved(ready(), 100, 1), { triangles: 100, vertices: 60, estimatedError: 0.1 }, 100);
  const measured = (): State => transitions.measuringEnded(transitions.measuringProgressed(shown(), 0.5), deviation, 'Measured.');

  it('is possible once the level that is wanted is on screen', () => {
    expect(transitions.canMeasure(opened().model!)).toBe(false);
    expect(transitions.canMeasure(transitions.targetMoved(ready(), 100, 1).model!)).toBe(false);
    expect(transitions.canMeasure(shown().model!)).toBe(true);
  });

  it('says so, can be cancelled, and leaves its figures', () => {
    const running = transitions.measuringProgressed(shown(), 0.5);
    expect(running.model?.measurement).toEqual({ kind: 'running', fraction: 0.5 });
    expect(statusText(running)).toBe('Measuring vase…');
    expect(transitions.canCancel(running)).toBe(true);
    expect(transitions.isBusy(running)).toBe(false);
    expect(measured().model?.measurement).toEqual({ kind: 'done', deviation });
    expect(statusText(measured())).toBe('Measured.');
    expect(transitions.canCancel(measured())).toBe(false);
    expect(transitions.measuringEnded(running, null, '').model?.measurement).toEqual({ kind: 'none' });
  });

  it('is forgotten when another level is wanted, and only then', () => {
    const none = { kind: 'none' };
    expect(transitions.targetMoved(measured(), 100, 2).model?.measurement).toEqual({ kind: 'done', deviation });
    expect(transitions.outputFormatChosen(measured(), 'obj').model?.measurement).toEqual({ kind: 'done', deviation });
    expect(transitions.targetMoved(measured(), 99, 2).model?.measurement).toEqual(none);
    expect(transitions.undone(measured()).model?.measurement).toEqual(none);
    expect(transitions.targetMoved(transitions.measuringProgressed(shown(), 0.5), 99, 2).model?.measurement).toEqual(none);
    expect(transitions.recordingProgressed(measured(), 0.1).model?.measurement).toEqual(none);
    expect(transitions.modelOpened(measured(), { name: 'b', credit: '', source, warnings: [], animations: [] }).model?.measurement).toEqual(none);
  });
});

describe('undo', () => {
  it('takes back one gesture at a time', () => {
    let state = ready();
    for (const triangles of [900, 800, 700]) state = transitions.targetMoved(state, triangles, 1);
    state = transitions.targetMoved(state, 300, 2);
    state = transitions.undone(state);
    expect(wanted(state)).toBe(700);
    state = transitions.undone(state);
    expect(wanted(state)).toBe(1000);
    expect(transitions.undone(state)).toBe(state);
    state = transitions.redone(transitions.redone(state));
    expect(wanted(state)).toBe(300);
    expect(transitions.redone(state)).toBe(state);
  });

  it('loses what was undone at the next move', () => {
    let state = transitions.undone(transitions.targetMoved(ready(), 500, 1));
    state = transitions.targetMoved(state, 400, 2);
    expect(transitions.redone(state)).toBe(state);
    expect(wanted(transitions.undone(state))).toBe(1000);
  });

  it('does not join moves across an undo', () => {
    let state = transitions.targetMoved(ready(), 500, 1);
    state = transitions.undone(state);
    state = transitions.targetMoved(state, 450, 1);
    expect(wanted(transitions.undone(state))).toBe(1000);
  });
});

describe('fitting for a download', () => {
  const writing = (): State => transitions.taskStarted(ready(), { kind: 'writing', name: 'vase.glb', fraction: null });

  it('is a part of the writing, with progress', () => {
    const fitting = transitions.fittingStarted(writing());
    expect(statusText(fitting)).toBe('Fitting vase.glb…');
    expect(transitions.isBusy(fitting)).toBe(true);
    expect(transitions.progress(transitions.fittingProgressed(fitting, 0.5))).toBe(0.5);
    expect(transitions.fittingEnded(fitting).task).toEqual(writing().task);
  });

  it('changes nothing about another task, or none', () => {
    const opening = transitions.taskStarted(ready(), { kind: 'opening', name: 'b.glb', fraction: 0.1 });
    for (const state of [opening, ready()]) {
      expect(transitions.fittingStarted(state)).toBe(state);
      expect(transitions.fittingProgressed(state, 0.5)).toBe(state);
      expect(transitions.fittingEnded(state)).toBe(state);
    }
  });

  it('makes what is shown and what was measured out of date until the level is there', () => {
    const deviation = { max: 1, mean: 0.1, rms: 0.2, relativeTo: 2 };
    const stale = transitions.levelStale(transitions.measuringEnded(ready(), deviation, ''));
    expect(stale.model?.measurement).toEqual({ kind: 'none' });
    expect(transitions.canMeasure(stale.model!)).toBe(false);
    expect(transitions.canMeasure(transitions.levelShown(stale, ready().model!.shown, 1000).model!)).toBe(true);
  });
});

describe('status', () => {
  it('says what is under way, then what is shown', () => {
    const opening = transitions.taskStarted(opened(), { kind: 'opening', name: 'a.glb', fraction: 0.5 });
    expect(statusText(opening)).toBe('Opening a.glb…');
    expect(transitions.progress(opening)).toBe(0.5);
    const recording = transitions.recordingProgressed(opened(), 0.25);
    expect(transitions.isBusy(recording)).toBe(true);
    expect(transitions.progress(recording)).toBe(0.25);
    expect(statusText(recording)).toBe('Simplifying vase…');
    expect(statusText(transitions.historyReady(opened(), 4))).toBe('Drawing vase…');
    expect(statusText(ready())).toBe('Ready. 1,000 triangles.');
    const stuck = transitions.historyReady(transitions.modelDrawn(opened()), 1000, { ...NOTHING, locked: 7 });
    expect(statusText(stuck)).toBe('Ready. 1,000 triangles. No fewer are possible: 100 % of the remaining edges are locked.');
    const moved = transitions.targetMoved(ready(), 11, 1);
    expect(statusText(moved)).toBe('Going to 11 triangles…');
    const shown = transitions.levelShown(moved, { triangles: 10, vertices: 7, estimatedError: 0.1 }, 11);
    const saved = transitions.remarked(shown, 'Saved.');
    expect(statusText(saved)).toBe('Saved.');
    expect(statusText(transitions.targetMoved(saved, 20, 2))).toBe('Going to 20 triangles…');
    expect(statusText(shown)).toBe('Ready. Showing 10 of 1,000 triangles.');
  });

  it('is usable after a cancelled recording', () => {
    const cancelled = transitions.recordingEnded(transitions.recordingProgressed(opened(), 0.5), 'Cancelled.');
    expect(transitions.isBusy(cancelled)).toBe(false);
    expect(statusText(cancelled)).toBe('Cancelled.');
  });
});

describe('the slider’s scale', () => {
  it('has both ends exactly and goes up', () => {
    for (const [fewest, all] of [[1, 1], [4, 5], [1, 12], [20, 69451], [1, 1_111_216]] as const) {
      expect(trianglesAtPosition(0, fewest, all)).toBe(fewest);
      expect(trianglesAtPosition(1, fewest, all)).toBe(all);
      let before = 0;
      for (let step = 0; step <= 100; step += 1) {
        const triangles = trianglesAtPosition(step / 100, fewest, all);
        expect(triangles).toBeGreaterThanOrEqual(before);
        before = triangles;
      }
    }
  });

  it('is its own inverse up to rounding', () => {
    for (const triangles of [20, 21, 100, 5000, 69450, 69451]) {
      expect(trianglesAtPosition(positionOfTriangles(triangles, 20, 69451), 20, 69451)).toBe(triangles);
    }
  });

  it('puts equal ratios at equal distances', () => {
    const at = (triangles: number): number => positionOfTriangles(triangles, 10, 100_000);
    expect(at(1000) - at(100)).toBeCloseTo(at(100_000) - at(10_000), 9);
  });
});

describe('figures', () => {
  it('writes sizes', () => {
    expect([0, 999, 1000, 12_345, 999_600, 1_234_567].map(formatBytes)).toEqual(['0 B', '999 B', '1 kB', '12.3 kB', '1 MB', '1.23 MB']);
  });

  it('writes shares without claiming all or nothing', () => {
    expect([0, 0.000001, 0.1234, 0.9999, 1].map(formatShare)).toEqual(['0 %', '< 0.001 %', '12.3 %', '> 99.9 %', '100 %']);
  });

  it('writes lengths', () => {
    expect([0, 0.0123456, 123.456, 0.0000123].map(formatLength)).toEqual(['0', '0.0123', '123', '1.23 × 10⁻⁵']);
  });
});
