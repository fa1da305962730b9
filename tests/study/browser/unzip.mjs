// SPDX-License-Identifier: GPL-3.0-or-later

import assert from 'node:assert/strict';
import { inflateRawSync } from 'node:zlib';

function crc32(bytes) {
  let crc = ~0;
  for (const byte of bytes) {
    crc ^= byte;
    for (let bit = 0; bit < 8; ++bit) crc = (crc >>> 1) ^ (crc & 1 ? 0xEDB88320 : 0);
  }
  return ~crc >>> 0;
}

/** The entries of a zip file, by name, each checked against its heads. */
export function unzip(zip) {
  const end = zip.lastIndexOf('PK\x05\x06', undefined, 'latin1');
  const entries = new Map();
  let at = zip.readUInt32LE(end + 16);
  for (let i = 0; i < zip.readUInt16LE(end + 10); ++i) {
    assert.equal(zip.toString('latin1', at, at + 4), 'PK\x01\x02');
    const [packed, size] = [zip.readUInt32LE(at + 20), zip.readUInt32LE(at + 24)];
    const [nameLength, extraLength, commentLength] = [28, 30, 32].map((place) => zip.readUInt16LE(at + place));
    const name = zip.toString('utf8', at + 46, at + 46 + nameLength);
    const local = zip.readUInt32LE(at + 42);
    assert.equal(zip.toString('latin1', local, local + 4), 'PK\x03\x04');
    // Version, flags and method; then checksum and sizes, unless flag 3 says that they follow the bytes.
    assert.ok(zip.subarray(local + 4, local + 10).equals(zip.subarray(at + 6, at + 12)), `${name}: both heads agree`);
    if ((zip.readUInt16LE(local + 6) & 8) === 0) {
      assert.ok(zip.subarray(local + 14, local + 26).equals(zip.subarray(at + 16, at + 28)), `${name}: both sizes agree`);
    }
    assert.equal(zip.toString('utf8', local + 30, local + 30 + zip.readUInt16LE(local + 26)), name);
    const begin = local + 30 + zip.readUInt16LE(local + 26) + zip.readUInt16LE(local + 28);
    const bytes = inflateRawSync(zip.subarray(begin, begin + packed));
    assert.equal(bytes.length, size, name);
    assert.equal(crc32(bytes), zip.readUInt32LE(at + 16), name);
    entries.set(name, bytes);
    at += 46 + nameLength + extraLength + commentLength;
  }
  return entries;
}
