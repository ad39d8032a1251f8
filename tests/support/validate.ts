// The Khronos validator's verdict on a file.
import { validateBytes } from 'gltf-validator';

/** The first errors it finds, one line each; none for a valid GLB. */
export async function gltfErrors(bytes: Uint8Array): Promise<string[]> {
  const { issues } = await validateBytes(bytes, { maxIssues: 100 });
  const errors = issues.messages.filter(({ severity }) => severity === 0);
  return errors.slice(0, 5).map(({ code, pointer, message }) => `${code} ${pointer} ${message}`);
}
