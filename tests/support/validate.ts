// The Khronos validator's verdict on a file.
import { validateBytes, type Message } from 'gltf-validator';

/** The errors it finds; `files` are what a .gltf refers to. */
export async function errorsOf(bytes: Uint8Array, files: ReadonlyArray<{ name: string; bytes: Uint8Array }> = []): Promise<Message[]> {
  return (await issuesOf(bytes, files)).filter(({ severity }) => severity === 0);
}

/** Everything it has to say, errors first. */
export async function issuesOf(bytes: Uint8Array, files: ReadonlyArray<{ name: string; bytes: Uint8Array }> = []): Promise<Message[]> {
  const externalResourceFunction = async (uri: string): Promise<Uint8Array> => {
    const found = files.find(({ name }) => name === decodeURIComponent(uri));
    if (!found) throw new Error(`${uri} is not there`);
    return found.bytes;
  };
  const { issues } = await validateBytes(bytes, { maxIssues: 1000, externalResourceFunction });
  return issues.messages;
}

/** The first errors it finds, one line each; none for a valid GLB. */
export async function gltfErrors(bytes: Uint8Array): Promise<string[]> {
  return (await errorsOf(bytes)).slice(0, 5).map(({ code, pointer, message }) => `${code} ${pointer} ${message}`);
}
