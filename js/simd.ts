// Whether this engine runs WebAssembly's 128-bit vector instructions.

/** Tells by validating a module whose one function makes a vector; nothing is compiled or run. */
export function supportsSimd(): boolean {
  const section = (id: number, ...content: number[]): number[] => [id, content.length, ...content];
  const v128 = 0x7b;
  const i32Const0 = [0x41, 0x00];
  const i32x4Splat = [0xfd, 0x11];
  const end = 0x0b;
  const body = [0x00 /* no locals */, ...i32Const0, ...i32x4Splat, end];
  const module = [
    ...[0x00, 0x61, 0x73, 0x6d], // "\0asm"
    ...[0x01, 0x00, 0x00, 0x00], // version 1
    ...section(1, 1, 0x60, 0, 1, v128), // one type: () → v128
    ...section(3, 1, 0), // one function of that type
    ...section(10, 1, body.length, ...body),
  ];
  return WebAssembly.validate(new Uint8Array(module));
}
