// The little YAML that rigs are written in: two levels of `key: value`, numbers, texts, and lists in
// brackets or by dashes, which may hold lists in turn (matrices). The service reads rigs by a whole parser before it stores them.

export type YamlValue = number | string | boolean | null | YamlValue[] | { [key: string]: YamlValue };

interface Line {
  indent: number;
  text: string;
  number: number;
}

/** Throws with the number of a line that it does not understand. */
export function parseYaml(source: string): { [key: string]: YamlValue } {
  const reader = new Reader(linesOf(source));
  const value = reader.block(0);
  if (value === null) return {};
  if (typeof value !== 'object' || Array.isArray(value)) throw new Error('line 1: a key was expected');
  return value;
}

function linesOf(source: string): Line[] {
  const lines: Line[] = [];
  source.split(/\r?\n/).forEach((raw, i) => {
    const text = raw.replace(/("[^"]*"|'[^']*')|(?:^|\s)#.*$/g, (_, quoted?: string) => quoted ?? '').trimEnd();
    if (text.trim() === '' || /^(---|\.\.\.|%)/.test(text)) return;
    const last = lines.at(-1);
    // A list in brackets may go on over several lines.
    if (last && depthOf(last.text) > 0) last.text += ` ${text.trim()}`;
    else lines.push({ indent: text.length - text.trimStart().length, text: text.trim(), number: i + 1 });
  });
  return lines;
}

function depthOf(text: string): number {
  return (text.match(/\[/g) ?? []).length - (text.match(/\]/g) ?? []).length;
}

class Reader {
  private at = 0;

  constructor(private readonly lines: Line[]) {}

  /** What stands from here on at `indent` or deeper. */
  block(indent: number): YamlValue {
    const first = this.lines[this.at];
    if (!first || first.indent < indent) return null;
    return /^-( |$)/.test(first.text) ? this.list(first.indent) : this.map(first.indent);
  }

  private list(indent: number): YamlValue[] {
    const values: YamlValue[] = [];
    for (let line = this.lines[this.at]; line && line.indent === indent && /^-( |$)/.test(line.text); line = this.lines[this.at]) {
      const rest = line.text.slice(1).trim();
      if (rest === '') {
        this.at += 1;
        values.push(this.block(indent + 1));
      } else if (/^-( |$)/.test(rest)) {
        // "- - 1": a list within the list begins on the same line.
        const inner = indent + line.text.length - rest.length;
        this.lines[this.at] = { ...line, indent: inner, text: rest };
        values.push(this.block(inner));
      } else {
        this.at += 1;
        values.push(scalar(rest, line.number));
      }
    }
    return values;
  }

  private map(indent: number): { [key: string]: YamlValue } {
    const values: { [key: string]: YamlValue } = {};
    for (let line = this.lines[this.at]; line && line.indent >= indent; line = this.lines[this.at]) {
      const found = line.indent === indent ? /^([^:[\]{}]+?)\s*:(?:\s+(.*))?$/.exec(line.text) : null;
      if (!found) throw new Error(`line ${line.number}: "${line.text}" is not understood`);
      const [, key, rest = ''] = found;
      this.at += 1;
      const next = this.lines[this.at];
      const isList = next !== undefined && next.indent === indent && /^-( |$)/.test(next.text); // dashes may stand below the key itself
      values[unquoted(key!)] = rest !== '' ? scalar(rest, line.number) : this.block(isList ? indent : indent + 1);
    }
    return values;
  }
}

function scalar(text: string, number: number): YamlValue {
  if (text.startsWith('[')) return flowList(text, number);
  if (/^["']/.test(text)) return unquoted(text);
  if (text === 'true' || text === 'false') return text === 'true';
  if (text === 'null' || text === '~') return null;
  const value = Number(text);
  return Number.isNaN(value) ? text : value;
}

function flowList(text: string, number: number): YamlValue[] {
  if (!text.endsWith(']')) throw new Error(`line ${number}: a list has no end`);
  const items: YamlValue[] = [];
  let depth = 0;
  let item = '';
  for (const letter of `${text.slice(1, -1)},`) {
    if (letter === '[') depth += 1;
    if (letter === ']') depth -= 1;
    if (depth < 0) throw new Error(`line ${number}: a bracket is closed that was not opened`);
    if (letter !== ',' || depth > 0) item += letter;
    else {
      if (item.trim() !== '') items.push(scalar(item.trim(), number));
      item = '';
    }
  }
  if (depth > 0) throw new Error(`line ${number}: a list has no end`);
  return items;
}

function unquoted(text: string): string {
  return /^(["']).*\1$/.test(text) ? text.slice(1, -1) : text;
}
