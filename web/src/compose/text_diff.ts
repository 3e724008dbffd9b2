// Differences of two texts by lines, for people: what went, what came, and two lines around.
export interface DiffLine {
  kind: "same" | "gone" | "new" | "gap";
  text: string;
  line: number; // in the newer text, or in the older one for what went
}

const cells = 4_000_000; // beyond it the middle is shown as replaced

export function diffLines(before: string, after: string, around = 2): DiffLine[] {
  const a = before.split(/\r?\n/);
  const b = after.split(/\r?\n/);
  let head = 0;
  while (head < a.length && head < b.length && a[head] === b[head]) head++;
  let tail = 0;
  while (
    tail < a.length - head &&
    tail < b.length - head &&
    a[a.length - 1 - tail] === b[b.length - 1 - tail]
  )
    tail++;
  const middle = changes(a.slice(head, a.length - tail), b.slice(head, b.length - tail), head);
  const all: DiffLine[] = [
    ...b.slice(0, head).map((text, i): DiffLine => ({ kind: "same", text, line: i + 1 })),
    ...middle,
    ...b
      .slice(b.length - tail)
      .map((text, i): DiffLine => ({ kind: "same", text, line: b.length - tail + i + 1 })),
  ];
  const near = new Set<number>();
  all.forEach((line, i) => {
    if (line.kind !== "same") for (let k = i - around; k <= i + around; k++) near.add(k);
  });
  const shown: DiffLine[] = [];
  all.forEach((line, i) => {
    if (near.has(i)) shown.push(line);
    else if (shown.length > 0 && shown.at(-1)?.kind !== "gap")
      shown.push({ kind: "gap", text: "", line: line.line });
  });
  if (shown.at(-1)?.kind === "gap") shown.pop();
  return shown;
}

// A piece of a text that another text has otherwise: lines `from` to `to` (without it) became `lines`.
export interface Hunk {
  from: number;
  to: number;
  lines: string[];
}
// What makes one list of lines the other.
export function hunksOf(before: string[], after: string[]): Hunk[] {
  let head = 0;
  while (head < before.length && head < after.length && before[head] === after[head]) head++;
  let tail = 0;
  while (
    tail < before.length - head &&
    tail < after.length - head &&
    before[before.length - 1 - tail] === after[after.length - 1 - tail]
  )
    tail++;
  const hunks: Hunk[] = [];
  let at = head;
  let open = false;
  for (const line of changes(
    before.slice(head, before.length - tail),
    after.slice(head, after.length - tail),
    head,
  )) {
    if (line.kind === "same") {
      at++;
      open = false;
      continue;
    }
    if (!open) hunks.push({ from: at, to: at, lines: [] });
    open = true;
    const hunk = hunks[hunks.length - 1]!;
    if (line.kind === "new") hunk.lines.push(line.text);
    else hunk.to = ++at;
  }
  return hunks;
}

function changes(a: string[], b: string[], head: number): DiffLine[] {
  const gone = (i: number): DiffLine => ({ kind: "gone", text: a[i] ?? "", line: head + i + 1 });
  const come = (j: number): DiffLine => ({ kind: "new", text: b[j] ?? "", line: head + j + 1 });
  if (a.length * b.length > cells) return [...a.map((_, i) => gone(i)), ...b.map((_, j) => come(j))];
  const width = b.length + 1;
  const longest = new Uint32Array((a.length + 1) * width);
  for (let i = a.length - 1; i >= 0; i--)
    for (let j = b.length - 1; j >= 0; j--)
      longest[i * width + j] =
        a[i] === b[j]
          ? (longest[(i + 1) * width + j + 1] ?? 0) + 1
          : Math.max(longest[(i + 1) * width + j] ?? 0, longest[i * width + j + 1] ?? 0);
  const lines: DiffLine[] = [];
  let i = 0;
  let j = 0;
  while (i < a.length || j < b.length) {
    if (i < a.length && j < b.length && a[i] === b[j]) {
      lines.push({ kind: "same", text: b[j] ?? "", line: head + j + 1 });
      i++;
      j++;
    } else if (
      j < b.length &&
      (i === a.length || (longest[i * width + j + 1] ?? 0) > (longest[(i + 1) * width + j] ?? 0))
    )
      lines.push(come(j++));
    else lines.push(gone(i++));
  }
  return lines;
}

// What a text is proposed to be deployed as: its own version where that is above the live one, else the one after that.
export function proposedVersion(mine: string, live: string): string {
  return isAbove(mine, live) ? mine : nextVersion(live);
}
// "1.10" is above "1.9". What has no numbers is above what it differs from: nobody can tell.
function isAbove(a: string, b: string): boolean {
  const numbers = (version: string) => version.match(/\d+/g)?.map(Number) ?? [];
  const [left, right] = [numbers(a), numbers(b)];
  if (left.length === 0 || right.length === 0) return a !== b && a !== "";
  for (let i = 0; i < Math.max(left.length, right.length); i++)
    if ((left[i] ?? 0) !== (right[i] ?? 0)) return (left[i] ?? 0) > (right[i] ?? 0);
  return false;
}
// "1.0" is followed by "1.1".
export function nextVersion(version: string): string {
  return version.replace(/\d+(?=\D*$)/, (number) => `${Number(number) + 1}`);
}
