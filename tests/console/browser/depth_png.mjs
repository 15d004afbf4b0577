// Depth images.
import { deflateSync } from "node:zlib";

// Rows of 16-bit values as a PNG, each row with the next filter. Its checksums are 0, which the page does not check.
export function png(rows) {
  const width = rows[0].length;
  const raw = Buffer.alloc(rows.length * (2 * width + 1));
  const plain = rows.map((row) => row.flatMap((value) => [value >> 8, value & 255]));
  const paeth = (a, b, c) => {
    const p = a + b - c;
    const [pa, pb, pc] = [Math.abs(p - a), Math.abs(p - b), Math.abs(p - c)];
    return pa <= pb && pa <= pc ? a : pb <= pc ? b : c;
  };
  plain.forEach((row, y) => {
    raw[y * (2 * width + 1)] = y % 5;
    row.forEach((value, i) => {
      const [left, up, corner] = [row[i - 2] ?? 0, plain[y - 1]?.[i] ?? 0, plain[y - 1]?.[i - 2] ?? 0];
      const minus = [0, left, up, (left + up) >> 1, paeth(left, up, corner)][y % 5];
      raw[y * (2 * width + 1) + 1 + i] = value - minus;
    });
  });
  const chunk = (type, data) => {
    const body = Buffer.concat([Buffer.from(type), data]);
    const sizes = Buffer.alloc(8);
    sizes.writeUInt32BE(data.length, 0);
    return Buffer.concat([sizes.subarray(0, 4), body, sizes.subarray(4)]);
  };
  const head = Buffer.from([0, 0, 0, 0, 0, 0, 0, 0, 16, 0, 0, 0, 0]);
  head.writeUInt32BE(width, 0);
  head.writeUInt32BE(rows.length, 4);
  const data = deflateSync(raw);
  return new Uint8Array(Buffer.concat([
    Buffer.from([137, 80, 78, 71, 13, 10, 26, 10]), chunk("IHDR", head), chunk("IDAT", data.subarray(0, 20)), chunk("IDAT", data.subarray(20)),
    chunk("IEND", Buffer.alloc(0)),
  ]));
}
