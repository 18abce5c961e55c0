// Reads CBOR (RFC 8949) as the service writes it. Arrays of numbers (RFC 8746) come as typed arrays, those of several
// extents with their `shape`.

const typed = { 86: Float64Array, 85: Float32Array, 78: Int32Array, 64: Uint8Array };

export function decode(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const text = new TextDecoder();
  let at = 0;

  function length(info) {
    if (info < 24) return info;
    const size = 1 << (info - 24);
    const start = at;
    at += size;
    if (size === 1) return view.getUint8(start);
    if (size === 2) return view.getUint16(start);
    return size === 4 ? view.getUint32(start) : Number(view.getBigUint64(start));
  }

  /// Items up to the count, or up to the stop where there is none.
  function each(info, use) {
    if (info === 31) {
      while (bytes[at] !== 0xff) use();
      ++at;
    } else {
      for (let left = length(info); left > 0; --left) use();
    }
  }

  function string(info, make) {
    if (info === 31) {
      const pieces = [];
      each(info, () => pieces.push(value()));
      return pieces.join("");
    }
    const start = at + (info < 24 ? 0 : 1 << (info - 24)), size = length(info);
    at += size;
    return make(bytes.subarray(start, start + size));
  }

  function tagged(tag) {
    const own = value();
    if (tag === 40) return Object.assign(own[1], { shape: Array.from(own[0]) });
    // A copy, for typed arrays begin at a multiple of their size.
    return tag in typed ? new typed[tag](own.slice().buffer) : own;
  }

  function simple(info) {
    if (info === 25) return half(length(25));
    if (info === 26) { at += 4; return view.getFloat32(at - 4); }
    if (info === 27) { at += 8; return view.getFloat64(at - 8); }
    return { 20: false, 21: true, 22: null }[info];
  }

  function half(bits) {
    const power = (bits >> 10) & 31, share = bits & 1023, sign = bits >> 15 ? -1 : 1;
    if (power === 31) return share ? NaN : sign * Infinity;
    return sign * (power ? (1 + share / 1024) * 2 ** (power - 15) : (share / 1024) * 2 ** -14);
  }

  function value() {
    const kind = bytes[at] >> 5, info = bytes[at++] & 31;
    if (kind === 0) return length(info);
    if (kind === 1) return -1 - length(info);
    if (kind === 2) return string(info, (own) => own);
    if (kind === 3) return string(info, (own) => text.decode(own));
    if (kind === 6) return tagged(length(info));
    if (kind === 7) return simple(info);
    if (kind === 4) {
      const list = [];
      each(info, () => list.push(value()));
      return list;
    }
    const members = {};
    each(info, () => { const key = value(); members[key] = value(); });
    return members;
  }

  return value();
}
