// Gathers the files of a model from a drop or a file input, each under its path as a model refers to it.

/** File name endings that the engine reads. */
export const MODEL_EXTENSIONS: readonly string[] = ['glb', 'gltf', 'obj', 'ply', 'stl', 'off', 'smf', 'pmesh'];

/** Files in a folder beyond this are left out: somebody dropped or chose their disk. */
const FILE_LIMIT = 2000;

const extensionOf = (name: string): string => /\.([^./]+)$/.exec(name)?.[1]?.toLowerCase() ?? '';

/** `models/vase.v2.glb` → `vase.v2`. */
export const baseName = (name: string): string => {
  const last = name.split('/').pop() ?? name;
  return last.replace(/\.[^.]+$/, '') || last;
};

/** The file that is the model among its textures and buffers; the first one when none looks like a model. */
export const modelFile = (files: readonly File[]): File | undefined =>
  files.find((file) => MODEL_EXTENSIONS.includes(extensionOf(file.name))) ?? files[0];

/** Kinds of models that name other files. */
const WITH_FILES: readonly string[] = ['gltf', 'obj'];

/**
 * The models among `files`, each first in a list with the files that it may refer to, under the names it has for them.
 * A .zip is a model of its own where it is not alone.
 */
export function modelsOf(files: readonly File[]): File[][] {
  const models = files.filter(({ name }) => [...MODEL_EXTENSIONS, 'zip'].includes(extensionOf(name)));
  const others = files.filter((file) => !models.includes(file));
  return models.map((model) => {
    if (!WITH_FILES.includes(extensionOf(model.name))) return [named(model, model.name)];
    const folder = model.name.slice(0, model.name.lastIndexOf('/') + 1);
    return relativeToModel([model, ...others.filter(({ name }) => name.startsWith(folder))], model);
  });
}

/** The files of a drop, folders read to their depth. Call it inside the event: a drop's items are gone afterwards. */
export function filesOfDrop(transfer: DataTransfer): Promise<File[]> {
  const entries = [...transfer.items].map((item) => (item.kind === 'file' ? item.webkitGetAsEntry() : null));
  const found = entries.filter((entry) => entry !== null);
  if (!found.some((entry) => entry.isDirectory)) return Promise.resolve([...transfer.files]);
  return readEntries(found);
}

/** The files of a file input; with `webkitdirectory` under their paths in the folder, as from a drop. */
export const filesOfInput = (files: FileList): File[] => [...files].slice(0, FILE_LIMIT).map((file) => named(file, file.webkitRelativePath || file.name));

/** The files under the names that the model among them has for them: it names its textures relative to itself. */
export function relativeToModel(files: readonly File[], model = modelFile(files)): File[] {
  const folder = model?.name.includes('/') ? model.name.slice(0, model.name.lastIndexOf('/') + 1) : '';
  return files.map((file) => (file.name.startsWith(folder) ? named(file, file.name.slice(folder.length)) : file));
}

// A file made of a file shares its bytes.
const named = (file: File, name: string): File => (file.name === name ? file : new File([file], name, { type: file.type }));

async function readEntries(roots: FileSystemEntry[]): Promise<File[]> {
  const files: File[] = [];
  const waiting = roots.map((entry) => ({ entry, path: entry.name }));
  for (let next = waiting.shift(); next !== undefined && files.length < FILE_LIMIT; next = waiting.shift()) {
    const { entry, path } = next;
    if (isFile(entry)) {
      const file = await new Promise<File>((resolve, reject) => entry.file(resolve, reject));
      files.push(named(file, path));
    } else if (isDirectory(entry)) {
      for (const child of await readDirectory(entry)) waiting.push({ entry: child, path: `${path}/${child.name}` });
    }
  }
  return files;
}

const isFile = (entry: FileSystemEntry): entry is FileSystemFileEntry => entry.isFile;
const isDirectory = (entry: FileSystemEntry): entry is FileSystemDirectoryEntry => entry.isDirectory;

async function readDirectory(directory: FileSystemDirectoryEntry): Promise<FileSystemEntry[]> {
  const reader = directory.createReader();
  const all: FileSystemEntry[] = [];
  // Browsers hand out a hundred at a time and an empty list at the end.
  for (;;) {
    const some = await new Promise<FileSystemEntry[]>((resolve, reject) => reader.readEntries(resolve, reject));
    if (some.length === 0 || all.length >= FILE_LIMIT) return all;
    all.push(...some);
  }
}
