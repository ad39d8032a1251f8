// The dropped file itself for the view, read while the engine still looks at it; shown only once the engine has found
// nothing in it to refuse, to change or to remark on.
import type { DocumentSummary } from 'decimesh/worker';
import type { PlainPart } from './preview/plain.ts';
import type { PlainModel, View } from './preview/view.ts';

/** A model on its way. Either `take` or `drop` is to be called, once. */
export interface EarlyModel {
  /** Resolves to the model if what the engine has read, `summary`, is the same vertex by vertex; else to null. */
  take(summary: DocumentSummary): Promise<PlainModel | null>;
  drop(): void;
}

/** Has the view read `files` if they are one that it might understand. */
export function readEarly(view: View, files: readonly File[]): EarlyModel {
  const [file] = files;
  const reading = files.length === 1 && file !== undefined ? view.loadPlain(file) : Promise.resolve(null);
  const drop = (): void => void reading.then((found) => found?.model.discard());
  return {
    drop,
    take: async (summary) => {
      // Then it need not even be waited for.
      if (summary.warnings.length > 0) return drop(), null;
      const found = await reading;
      if (found === null || agrees(summary, found.parts)) return found;
      found.model.discard();
      return null;
    },
  };
}

/** Whether the engine has as many vertices in each primitive as the file, and so all of them, and all triangles. */
export function agrees({ groups, wedgeSets, triangles, warnings }: Pick<DocumentSummary, 'groups' | 'wedgeSets' | 'triangles' | 'warnings'>, parts: readonly PlainPart[]): boolean {
  if (warnings.length > 0 || parts.length !== groups.length) return false;
  if (parts.reduce((sum, part) => sum + part.triangles, 0) !== triangles) return false;
  const vertices = new Map(parts.map((part) => [`${part.mesh}/${part.primitive}`, part.vertices]));
  return groups.every(({ mesh, primitive, wedgeSet }) => vertices.get(`${mesh}/${primitive}`) === wedgeSets[wedgeSet]?.vertices);
}
