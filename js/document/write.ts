// Levels as files: one as it is selected, the largest that fits a number of bytes, or a chain of them.

import { encodeGlb, type EncodedFiles } from '../codecs/encode.js';
import type { EngineObject } from '../engine.js';
import { holdsEncodings } from '../formats.js';
import { packLods } from '../lods.js';
import { partsOf, partsSource, type Parts } from '../parts.js';
import { makeReport, type Deviation, type Report, type ReportedLod, type Timings } from '../report.js';
import { screenCoverages } from '../screen.js';
import { findSize } from '../size.js';
import type { DocumentSummary, LevelSummary, LevelTargets, LodSwitch, Warning, WriteOptions } from '../types.js';
import type { Model } from '../wasm/decimesh.js';
import { resolveWriteOptions, type ResolvedWriteOptions } from './write_options.js';

/** A written file with the report on it. */
export interface Written {
  readonly bytes: Uint8Array<ArrayBuffer>;
  /** What a `.gltf` refers to, under the names by which it does; empty for other formats. */
  readonly files: ReadonlyArray<{ readonly name: string; readonly bytes: Uint8Array<ArrayBuffer> }>;
  /** `path`s are null; the output's size is that of all files. */
  readonly report: Report;
}

/** The selected level, and what is known of it. */
export interface LevelState {
  /** Undefined before the first simplification: full detail. */
  readonly level: LevelSummary | undefined;
  readonly timings: Pick<Timings, 'read' | 'simplify'>;
  /** Undefined when the level was not measured. */
  readonly measured: { readonly deviation: Deviation; readonly milliseconds: number } | undefined;
}

/** A document as seen from here. */
export interface LevelSource {
  readonly summary: DocumentSummary;
  readonly model: EngineObject<Model>;
  /** Selects a level. */
  level(targets: LevelTargets): Promise<LevelSummary>;
  /** The level that is selected at the call; a copy. */
  state(): LevelState;
  /** What the input was made of. */
  inputParts(): Parts;
}

/** About how many of the geometry's bytes are left by what packs them; enough for a first guess. */
const SHARES = { meshopt: 0.4, draco: 0.15 } as const;

/** A level as the bytes of files, and the state it was taken in. */
interface EncodedLevel extends EncodedFiles {
  readonly losses: readonly Warning[];
  readonly state: LevelState;
  readonly parts: Parts;
}

/** Writes as `Document.write` says. */
export async function writeLevels(source: LevelSource, options: WriteOptions): Promise<Written> {
  const resolved = resolveWriteOptions(options, source.summary);
  const { format } = resolved;
  const start = performance.now();
  const writer = new LevelWriter(source, resolved);
  const chain = options.lods && (await writer.chain(options.lods, options.lodSwitch));
  const encoded = chain?.encoded ?? (options.size === undefined ? await writer.selected() : await writer.within(options.size));
  const { bytes, files, warnings, dropped, losses, state, parts } = encoded;
  const { level, measured } = state;
  const timings = { ...state.timings, write: performance.now() - start, measure: measured?.milliseconds ?? 0 };
  const size = sizeOf(encoded);
  const told = [...losses, ...warnings];
  if (options.size !== undefined && size > options.size) {
    told.push({ code: 'size-not-reached', message: `the smallest recorded level takes ${size} bytes`, where: '' });
  }
  const output = { format, bytes: size, parts, triangles: (level?.triangles ?? source.summary.triangles) - dropped };
  const report = {
    summary: source.summary, level, deviation: measured?.deviation, output, parts: source.inputParts(), timings, losses: told, lods: chain?.lods,
  };
  return { bytes, files, report: makeReport(report) };
}

/** Writes levels of one document in one way. */
class LevelWriter {
  readonly #source: LevelSource;
  readonly #options: ResolvedWriteOptions;
  /** The engine knows glTF in one file, and the text is made of that. */
  readonly #engineFormat: string;

  constructor(source: LevelSource, options: ResolvedWriteOptions) {
    this.#source = source;
    this.#options = options;
    this.#engineFormat = options.format === 'gltf' ? 'glb' : options.format;
  }

  /** The selected level. */
  async selected(): Promise<EncodedLevel> {
    return this.#encode(this.#writeInEngine());
  }

  /** The largest recorded level of at most `limit` bytes, or the smallest if none is; it is selected. */
  async within(limit: number): Promise<EncodedLevel> {
    const source = this.#source;
    const { triangles: most } = source.summary;
    const { triangles: least } = await source.level({ triangles: 0 });
    const found = await findSize(limit, { least, most, first: this.#trianglesOf(limit) }, async (wanted) => {
      // As far as it goes, and not to what that came to: the stop reason tells.
      const { triangles } = await source.level(wanted >= most ? {} : { triangles: wanted <= least ? 0 : wanted });
      const output = await this.selected();
      return { triangles, bytes: sizeOf(output), geometry: output.parts.geometry, output };
    });
    // The last one that was tried need not be the one that fits.
    await source.level({ triangles: found.bytes > limit ? 0 : found.triangles });
    return found.output;
  }

  /** A first guess of how many triangles `limit` bytes can hold. */
  #trianglesOf(limit: number): number {
    const { triangles, wedgeSets, compression } = this.#source.summary;
    const { compress, quantize } = this.#options.encoding;
    const { geometry, textures, animation } = this.#source.inputParts();
    // Numbers of four bytes for every vertex, and half of the indices in two.
    const plain = wedgeSets.reduce((sum, { vertices, attributes }) =>
      sum + attributes.reduce((bytes, { components }) => bytes + 4 * components, 12) * vertices, 9 * triangles);
    const isAsGiven = compress !== 'none' && compress === compression;
    const share = compress === 'none' ? (quantize ? 0.5 : 1) : SHARES[compress];
    const bytes = isAsGiven ? geometry : plain * share;
    // Meshopt packs animations too.
    const rest = textures + animation * (compress === 'meshopt' && !isAsGiven ? share : 1);
    return Math.floor((triangles * Math.max(0, limit - rest)) / Math.max(1, bytes));
  }

  /** The levels `wanted` in one file, each once; the finest is selected. */
  async chain(
    wanted: NonNullable<WriteOptions['lods']>,
    lodSwitch: LodSwitch | undefined,
  ): Promise<{ encoded: EncodedLevel; lods: ReportedLod[] }> {
    const source = this.#source;
    const targets = wanted.map((target) => (typeof target === 'number' ? { ratio: target } : target));
    const levels = new Map<number, { level: LevelSummary; targets: LevelTargets }>();
    for (const target of targets) {
      const level = await source.level(target);
      // What the constraints do not allow is the same level once more.
      if (!levels.has(level.triangles)) levels.set(level.triangles, { level, targets: target });
    }
    const chain = [...levels.values()].sort((a, b) => b.level.triangles - a.level.triangles);
    const coverages = screenCoverages(chain.map(({ level }) => level.estimatedError), source.summary.diagonal, lodSwitch);
    const files: Uint8Array<ArrayBuffer>[] = [];
    // The first one last: it stays selected.
    for (const { targets: target } of [...chain].reverse()) {
      await source.level(target);
      files.unshift(this.#writeInEngine());
    }
    const lods = chain.map(({ level }, index) => ({
      triangles: level.triangles,
      vertices: level.vertices,
      estimatedError: level.estimatedError,
      screenCoverage: coverages[index] as number,
    }));
    return { encoded: await this.#encode(packLods(files, coverages)), lods };
  }

  #writeInEngine(): Uint8Array<ArrayBuffer> {
    return this.#source.model.call((model) => model.write(this.#engineFormat)) as Uint8Array<ArrayBuffer>;
  }

  /** What the engine wrote of the selected level, in the encoding asked for. Everything that is written comes from here. */
  async #encode(written: Uint8Array<ArrayBuffer>): Promise<EncodedLevel> {
    const { format, name, encoding } = this.#options;
    const losses = JSON.parse(this.#source.model.call((model) => model.losses(this.#engineFormat))) as Warning[];
    // Another level may be selected while this one is encoded.
    const state = this.#source.state();
    const encoded = holdsEncodings(format)
      ? await encodeGlb(written, encoding, format === 'gltf' ? name : undefined)
      : { bytes: written, files: [], warnings: [], dropped: 0 };
    const parts = partsOf(partsSource([{ name: `output.${format}`, bytes: encoded.bytes }, ...encoded.files], format));
    return { ...encoded, losses, state, parts };
  }
}

function sizeOf({ bytes, files }: EncodedLevel): number {
  return files.reduce((sum, file) => sum + file.bytes.byteLength, bytes.byteLength);
}
