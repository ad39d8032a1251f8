// The part of gltf-validator that the tests use; the package has no types of its own.
declare module 'gltf-validator' {
  export interface Message {
    code: string;
    message: string;
    pointer: string;
    severity: number;
  }
  export function validateBytes(
    bytes: Uint8Array,
    options?: { maxIssues?: number; externalResourceFunction?: (uri: string) => Promise<Uint8Array> },
  ): Promise<{ issues: { numErrors: number; messages: Message[] } }>;
}
