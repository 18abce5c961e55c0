// Reads CBOR (RFC 8949) as the service writes it: whole numbers, those of eight bytes, and texts that say how long they
// are. Arrays of numbers (RFC 8746) come as typed arrays.

const typed = { 86: Float64Array, 78: Int32Array };

export function decode(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const text = new TextDecoder();
  let at = 0;

  function length(info) {
    if (info < 24) return info;
    const size = 1 << (info - 24);
    at += size;
    return size === 8 ? Number(view.getBigUint64(at - 8)) : view[`getUint${8 * size}`](at - size);
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

  function string(size) {
    at += size;
    return bytes.subarray(at - size, at);
  }

  /// A typed array is a copy, for it begins at a multiple of its size; tag 40 stands before its extents and it.
  function tagged(tag) {
    const own = value();
    return tag === 40 ? own[1] : new typed[tag](own.slice().buffer);
  }

  function simple(info) {
    if (info === 27) { at += 8; return view.getFloat64(at - 8); }
    return { 20: false, 21: true, 22: null }[info];
  }

  function value() {
    const kind = bytes[at] >> 5, info = bytes[at++] & 31;
    if (kind === 0) return length(info);
    if (kind === 1) return -1 - length(info);
    if (kind === 2) return string(length(info));
    if (kind === 3) return text.decode(string(length(info)));
    if (kind === 6) return tagged(length(info));
    if (kind === 7) return simple(info);
    if (kind === 4) {
      const list = [];
      each(info, () => list.push(value()));
      return list;
    }
    const members = Object.create(null); // any name may be one
    each(info, () => { const key = value(); members[key] = value(); });
    return members;
  }

  return value();
}
