// CRC-32 as zlib has it, four bytes at a time (slicing by 4).

const TABLES = Array.from({ length: 4 }, () => new Uint32Array(256));
for (let i = 0; i < 256; i++) {
  let c = i;
  for (let bit = 0; bit < 8; bit++) c = c & 1 ? (c >>> 1) ^ 0xedb88320 : c >>> 1;
  TABLES[0][i] = c >>> 0;
}
for (let t = 1; t < 4; t++) {
  for (let i = 0; i < 256; i++) {
    const c = TABLES[t - 1][i];
    TABLES[t][i] = (TABLES[0][c & 255] ^ (c >>> 8)) >>> 0;
  }
}
const [T0, T1, T2, T3] = TABLES;

/**
 * The checksum of `bytes` behind what `crc` is the checksum of; 0 to begin with.
 * @param {number} crc
 * @param {Uint8Array} bytes
 * @returns {number} 0 to 2^32 - 1
 */
export function crc32(crc, bytes) {
  let c = ~crc;
  let i = 0;
  for (const whole = bytes.length & ~3; i < whole; i += 4) {
    c ^= bytes[i] | (bytes[i + 1] << 8) | (bytes[i + 2] << 16) | (bytes[i + 3] << 24);
    c = T3[c & 255] ^ T2[(c >>> 8) & 255] ^ T1[(c >>> 16) & 255] ^ T0[c >>> 24];
  }
  for (; i < bytes.length; i++) c = T0[(c ^ bytes[i]) & 255] ^ (c >>> 8);
  return ~c >>> 0;
}
