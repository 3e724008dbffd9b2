// Places for the names of what moves on the map, beside it, so that they cover as little as can be. Metres; y to the south. A pure function.
export interface Box {
  x: number; // middle
  y: number;
  width: number;
  height: number;
}
export interface Mover {
  key: string;
  x: number;
  y: number;
  radius: number;
  text: string;
  size: number; // of its letters
}
const letter = 0.58; // of their size

const farther = 1.1; // of their size: where all places beside a thing are taken

export function textBox(x: number, baseline: number, text: string, size: number): Box {
  return { x, y: baseline - size * 0.35, width: text.length * size * letter, height: size };
}
function shared(a: Box, b: Box): number {
  const wide =
    Math.min(a.x + a.width / 2, b.x + b.width / 2) - Math.max(a.x - a.width / 2, b.x - b.width / 2);
  const high =
    Math.min(a.y + a.height / 2, b.y + b.height / 2) - Math.max(a.y - a.height / 2, b.y - b.height / 2);
  return wide > 0 && high > 0 ? wide * high : 0;
}

// Offsets of the names (middle and baseline) from their things: above, below, right or left, or a line farther, where least is
// covered; the first come first.
export function placeLabels(
  fixed: readonly Box[],
  movers: readonly Mover[],
): Map<string, { x: number; y: number }> {
  const taken = [
    ...fixed,
    ...movers.map((m): Box => ({ x: m.x, y: m.y, width: m.radius * 2, height: m.radius * 2 })),
  ];
  const places = new Map<string, { x: number; y: number }>();
  for (const mover of movers) {
    const half = (mover.text.length * mover.size * letter) / 2;
    const [above, below, aside] = [
      -mover.radius - 0.3 * mover.size,
      mover.radius + mover.size,
      mover.radius + half + 0.2,
    ];
    const offers = [
      { x: 0, y: above },
      { x: 0, y: below },
      { x: aside, y: mover.size * 0.35 },
      { x: -aside, y: mover.size * 0.35 },
      { x: aside, y: above },
      { x: -aside, y: above },
      { x: aside, y: below },
      { x: -aside, y: below },
      { x: 0, y: above - mover.size * farther },
      { x: 0, y: below + mover.size * farther },
      { x: aside, y: below + mover.size * farther },
      { x: -aside, y: below + mover.size * farther },
      { x: aside, y: above - mover.size * farther },
      { x: -aside, y: above - mover.size * farther },
    ];
    let best = offers[0]!;
    let least = Infinity;
    for (const offer of offers) {
      const box = textBox(mover.x + offer.x, mover.y + offer.y, mover.text, mover.size);
      const covered = taken.reduce((sum, other) => sum + shared(box, other), 0);
      if (covered < least - 1e-9) [best, least] = [offer, covered];
    }
    places.set(mover.key, best);
    taken.push(textBox(mover.x + best.x, mover.y + best.y, mover.text, mover.size));
  }
  return places;
}
