// Shows /openapi.json: every call, to read and to try, and every schema.

import { element } from "/pages/element.js";
import { getJson, withToken } from "/pages/service.js";
import { shell } from "/pages/shell.js";

const longestShown = 20000;

/// Markdown as far as descriptions use it: paragraphs, **strong**, `code`.
function inline(text) {
  return text.split(/(`[^`]*`|\*\*[^*]*\*\*)/).map((piece) => {
    if (piece.startsWith("`")) return element("code", {}, piece.slice(1, -1));
    return piece.startsWith("**") ? element("strong", {}, piece.slice(2, -2)) : piece;
  });
}
const paragraphs = (text = "") => text.split("\n\n").filter(Boolean).map((each) => element("p", {}, inline(each)));

const nameOf = (reference) => reference.split("/").at(-1);
const linkTo = (name) => element("a", { href: `#${name}` }, name);

/// What stands behind a $ref; members beside it come first.
function resolve(api, value) {
  if (!value?.$ref) return value;
  const target = value.$ref.slice(2).split("/").reduce((node, key) => node[key], api);
  return { ...target, ...value };
}

// --- schemas

/// The type of a schema in words, with links to the schemas that have a name.
function typeOf(schema) {
  const separated = (schemas, by) => schemas.flatMap((each, i) => (i ? [by, ...typeOf(each)] : typeOf(each)));
  if (schema.$ref) return [linkTo(nameOf(schema.$ref))];
  if (schema.oneOf || schema.anyOf) return separated(schema.oneOf ?? schema.anyOf, " or ");
  if (schema.enum) return [schema.enum.map((value) => JSON.stringify(value)).join(", ")];
  if ("const" in schema) return [JSON.stringify(schema.const)];
  const types = [schema.type ?? "any"].flat();
  const named = types.join(" or ");
  if (types[0] === "array" && schema.items) return ["array of ", ...typeOf(schema.items)];
  if (types[0] === "object" && schema.additionalProperties?.constructor === Object)
    return ["object of ", ...typeOf(schema.additionalProperties)];
  return [schema.format ? `${named} (${schema.format})` : named];
}

function rangeOf(schema) {
  const bounds = [
    ["minimum", "≥"], ["exclusiveMinimum", ">"], ["maximum", "≤"], ["exclusiveMaximum", "<"],
    ["minLength", "length ≥"], ["maxLength", "length ≤"], ["minItems", "entries ≥"], ["maxItems", "entries ≤"],
  ];
  return bounds.filter(([key]) => key in schema).map(([key, sign]) => `${sign} ${schema[key]}`).join(", ");
}

function facts(schema) {
  const lines = [rangeOf(schema)];
  if ("default" in schema) lines.push(`default ${JSON.stringify(schema.default)}`);
  if (schema.examples?.length) lines.push(`e.g. ${schema.examples.map((each) => JSON.stringify(each)).join(", ")}`);
  return lines.filter(Boolean).map((line) => element("div", { className: "quiet" }, line));
}

/// A row a member; the members of objects without a name of their own follow theirs.
function memberRows(api, schema, prefix = "") {
  return Object.entries(schema.properties ?? {}).flatMap(([name, member]) => {
    const required = schema.required?.includes(name) ? "" : element("span", { className: "quiet" }, " optional");
    const row = element("tr", {},
      element("th", {}, element("code", {}, prefix + name), required),
      element("td", {}, typeOf(member)),
      element("td", {}, inline(resolve(api, member).description ?? ""), facts(member)));
    return [row, ...memberRows(api, member, `${prefix}${name}.`)];
  });
}

function schemaSection(api, name, schema) {
  const rows = memberRows(api, schema);
  return element("section", { id: name },
    element("h3", {}, name), paragraphs(schema.description),
    rows.length ? element("table", {}, rows) : element("p", {}, typeOf(schema)),
    rows.length ? null : facts(schema));
}

// --- calls

function parameterRow(api, reference) {
  const parameter = resolve(api, reference);
  return element("tr", {},
    element("th", {}, element("code", {}, parameter.name), element("span", { className: "quiet" }, ` ${parameter.in}`)),
    element("td", {}, typeOf(parameter.schema)),
    element("td", {}, inline(parameter.description ?? ""), facts(resolve(api, parameter.schema))));
}

function responseRow(api, status, reference) {
  const response = resolve(api, reference);
  const types = Object.entries(response.content ?? {}).map(([type, content]) =>
    element("div", {}, type, content.schema ? [": ", ...typeOf(content.schema)] : null));
  return element("tr", {}, element("th", {}, status), element("td", {}, types),
    element("td", {}, inline(response.description)));
}

/// The body of a reply as text, cut where nobody reads on.
async function shownBody(reply) {
  const text = await reply.text();
  const isJson = reply.headers.get("Content-Type")?.includes("json");
  const pretty = isJson && text.length < longestShown ? JSON.stringify(JSON.parse(text), null, 2) : text;
  return pretty.length > longestShown ? `${pretty.slice(0, longestShown)}\n… ${pretty.length} characters` : pretty;
}

async function send(method, path, parameters, form, output) {
  const query = new URLSearchParams();
  const headers = {};
  for (const parameter of parameters) {
    const value = form.elements[parameter.name].value;
    if (parameter.in === "path") path = path.replace(`{${parameter.name}}`, encodeURIComponent(value));
    else if (value && parameter.in === "query") query.set(parameter.name, value);
    else if (value) headers[parameter.name] = value;
  }
  const body = form.elements.body?.value;
  if (body) headers["Content-Type"] = "application/json";
  const target = query.size ? `${path}?${query}` : path;
  output.textContent = `${method} ${target} …`;
  try {
    const reply = await fetch(target, { method, headers: withToken(headers), body });
    const head = [...reply.headers].map(([name, value]) => `${name}: ${value}`).join("\n");
    output.textContent = `${reply.status} ${reply.statusText}\n${head}\n\n${await shownBody(reply)}`;
  } catch (error) {
    output.textContent = String(error);
  }
}

/// A choice of the examples of the body, and the body.
function bodyFields(api, reference) {
  const content = resolve(api, reference).content["application/json"];
  const examples = Object.entries(content.examples ?? {});
  const body = element("textarea", { name: "body", spellcheck: false, ariaLabel: "Body" });
  const choice = element("select", {}, examples.map(([name, example]) =>
    element("option", { value: name }, `${name}: ${example.summary}`)));
  const fill = () => { body.value = JSON.stringify(content.examples[choice.value].value, null, 2); };
  choice.onchange = fill;
  choice.value = "paper-nonconforming";
  if (examples.length) fill();
  return [element("label", {}, "Example", choice), body];
}

function trial(api, method, path, parameters, operation) {
  const output = element("pre", { hidden: true });
  const form = element("form", {},
    parameters.map((parameter) => element("label", {}, parameter.name,
      element("input", { name: parameter.name, required: Boolean(parameter.required) }))),
    operation.requestBody ? bodyFields(api, operation.requestBody) : null,
    element("button", {}, "Send"));
  form.onsubmit = (event) => {
    event.preventDefault();
    output.hidden = false;
    send(method, path, parameters, form, output);
  };
  return element("details", {}, element("summary", {}, "Try it"), form, output);
}

function callSection(api, path, method, operation, shared) {
  const references = [...(shared ?? []), ...(operation.parameters ?? [])];
  const parameters = references.map((reference) => resolve(api, reference));
  const body = operation.requestBody ? resolve(api, operation.requestBody) : null;
  return element("section", { id: operation.operationId },
    element("h3", {}, element("span", { className: "method" }, method), element("code", {}, path)),
    element("p", {}, element("strong", {}, operation.summary), ". ", inline(operation.description ?? "")),
    references.length ? element("table", {}, references.map((each) => parameterRow(api, each))) : null,
    body ? element("p", {}, "Body: ", typeOf(body.content["application/json"].schema), ". ", inline(body.description)) : null,
    element("table", {}, Object.entries(operation.responses).map(([status, each]) => responseRow(api, status, each))),
    trial(api, method, path, parameters, operation));
}

/// Every call of a tag: its section and its line in the contents.
function callsOf(api, tag) {
  return Object.entries(api.paths).flatMap(([path, item]) =>
    Object.entries(item)
      .filter(([, operation]) => operation.tags?.includes(tag))
      .map(([method, operation]) => ({
        section: callSection(api, path, method.toUpperCase(), operation, item.parameters),
        line: element("a", { href: `#${operation.operationId}`, title: path }, operation.summary),
      })));
}

function show(main, api) {
  const contents = element("nav", { className: "contents", ariaLabel: "Contents" });
  const text = element("div", { className: "document" }, element("h1", {}, api.info.title),
    paragraphs(api.info.summary), paragraphs(api.info.description),
    element("p", {}, element("a", { href: "/openapi.json" }, `OpenAPI ${api.openapi}`)));
  const chapter = (name, about, lines, sections) => {
    contents.append(element("h2", {}, name), ...lines);
    text.append(element("h2", {}, name), ...paragraphs(about), ...sections);
  };
  for (const { name, description } of api.tags) {
    const calls = callsOf(api, name);
    chapter(name, description, calls.map(({ line }) => line), calls.map(({ section }) => section));
  }
  const schemas = Object.entries(api.components.schemas);
  chapter("schemas", "", schemas.map(([name]) => linkTo(name)), schemas.map(([name, schema]) => schemaSection(api, name, schema)));
  main.append(contents, text);
  document.getElementById(location.hash.slice(1))?.scrollIntoView();
}

const main = shell();
try {
  show(main, await getJson("/openapi.json"));
} catch (error) {
  main.append(element("p", { className: "fault", role: "alert" }, `The document cannot be shown: ${error.message}`));
}
