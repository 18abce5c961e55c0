// What the OpenAPI document says of a place in a problem.

const parts = (pointer) => pointer.split("/").slice(1).map((part) => part.replaceAll("~1", "/").replaceAll("~0", "~"));

export class Schema {
  constructor(api) {
    this.api = api;
  }

  /// The schemas behind references and alternatives.
  alternatives(schema) {
    if (!schema) return [];
    const own = schema.$ref ? schema.$ref.slice(2).split("/").reduce((node, key) => node[key], this.api) : schema;
    const others = [...(own.oneOf ?? []), ...(own.anyOf ?? []), ...(own.allOf ?? [])];
    if (!others.length) return [{ ...own, ...schema, $ref: undefined }];
    const shared = own.properties ? [own] : [];
    return [...shared, ...others.flatMap((each) => this.alternatives(each))];
  }

  /// Those that hold for the value at a pointer of the document; an alternative whose constant members say otherwise
  /// is left out.
  at(pointer, document) {
    let schemas = this.alternatives({ $ref: "#/components/schemas/Problem" });
    let value = document;
    for (const part of parts(pointer)) {
      const fitting = schemas.filter((each) => this.fits(each, value));
      schemas = (fitting.length ? fitting : schemas).flatMap((each) => this.alternatives(
        each.properties?.[part] ?? (each.type?.includes?.("array") ? each.prefixItems?.[part] ?? each.items : typeof each.additionalProperties === "object" ? each.additionalProperties : null)));
      value = value?.[part];
    }
    const fitting = schemas.filter((each) => this.fits(each, value));
    return fitting.length ? fitting : schemas;
  }

  fits(schema, value) {
    if (value === null || typeof value !== "object") return true;
    return Object.entries(schema.properties ?? {}).every(([name, member]) => {
      const known = this.alternatives(member).flatMap((each) => ("const" in each ? [each.const] : each.enum ?? []));
      return !known.length || !(name in value) || known.includes(value[name]);
    });
  }

  /// Names of members that may stand in the object, with what they are.
  members(pointer, document) {
    const found = new Map();
    for (const each of this.at(pointer, document))
      for (const [name, member] of Object.entries(each.properties ?? {})) {
        const about = member.description ?? this.alternatives(member)[0]?.description ?? "";
        found.set(name, { text: name, about: about.split(/(?<=\.)\s/)[0], schemas: this.alternatives(member) });
      }
    return [...found.values()];
  }

  /// Values that may stand there.
  values(pointer, document) {
    return [...new Set(this.at(pointer, document).flatMap((each) =>
      "const" in each ? [each.const] : each.enum ?? (each.type === "boolean" ? [true, false] : "default" in each ? [each.default] : each.examples ?? [])).map((each) => JSON.stringify(each)))]
      .map((text) => ({ text, about: "" }));
  }
}

/// What to begin the value of a member with.
export function beginning(schemas) {
  const types = schemas.flatMap((each) => each.type ?? []);
  if (types.length && types.every((type) => type === "object")) return "{}";
  if (types.length && types.every((type) => type === "array")) return "[]";
  const constants = schemas.flatMap((each) => ("const" in each ? [each.const] : []));
  return constants.length === 1 && schemas.length === 1 ? JSON.stringify(constants[0]) : "";
}
