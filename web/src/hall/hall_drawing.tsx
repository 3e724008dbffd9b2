// The drawing of the hall: metres in, y to the north. The layout is drawn once; what moves is drawn above it.
import { memo, useCallback, useLayoutEffect, useMemo, useRef, useState } from "react";
import type { RobotStatus } from "../gen/docent/v1/fleet_pb";
import { type Box, placeLabels, textBox } from "./label_places";
import { centre, type Layout, type Person, type Point, type Shape } from "./layout";
import { taskWords } from "./robot_words";
import { restOf, type Way } from "./ways";

// Sizes of letters: as many metres as look well where the whole hall is seen, within pixels that can be read; the same over the zoom.
interface Letters {
  booth: number;
  region: number;
  detail: number;
  robot: number;
  person: number;
  stop: number; // of a tour, in its disc
}
// In metres, at so many metres a pixel; `whole`: where the whole hall is seen.
export function lettersAt(metresAPixel: number, whole: number): Letters {
  const of = (metres: number, least: number, most: number) =>
    Math.min(most, Math.max(least, metres / whole)) * metresAPixel;
  return {
    booth: of(0.74, 12, 20),
    region: of(0.56, 11, 15),
    detail: of(0.5, 11, 13.5),
    robot: of(0.62, 12, 17),
    person: of(0.5, 11, 14),
    stop: of(0.56, 11, 15),
  };
}
const outline = 0.22; // of a name on the map, as a part of its letters' size
const labelsPlaced = 60; // things that move whose names are placed with care
const shownDeviations = 2; // the robot is within this circle at about 95 %

export interface Camera {
  x: number; // middle, in metres
  y: number;
  scale: number; // 1: the whole hall; smaller is nearer
}

// The camera as it is where the place is seen, else moved there as near as it is.
export function broughtIntoView(
  camera: Camera | null,
  layout: Pick<Layout, "min" | "max"> | undefined,
  at: { x: number; y: number },
): Camera | null {
  if (!camera || !layout) return camera;
  const half = {
    x: ((layout.max.x - layout.min.x + 2) * camera.scale) / 2,
    y: ((layout.max.y - layout.min.y + 2) * camera.scale) / 2,
  };
  const seen = Math.abs(at.x - camera.x) < half.x * 0.85 && Math.abs(at.y - camera.y) < half.y * 0.85;
  return seen ? camera : { ...camera, x: at.x, y: at.y };
}

export function HallDrawing(props: {
  layout: Layout;
  robots: readonly RobotStatus[];
  people: readonly Person[];
  trails: ReadonlyMap<string, Point[]>;
  ways: ReadonlyMap<string, Way>;
  picked: string;
  camera: Camera | null;
  onCamera: (camera: Camera | null) => void;
  onPick: (iri: string) => void;
  tour?: readonly { x: number; y: number }[];
}) {
  const { layout, camera } = props;
  const latestPick = useRef(props.onPick);
  latestPick.current = props.onPick;
  const stablePick = useCallback((iri: string) => latestPick.current(iri), []);
  const svg = useRef<SVGSVGElement>(null);
  const drag = useRef<{ x: number; y: number; camera: Camera; moved: boolean } | null>(null);
  const width = layout.max.x - layout.min.x + 2;
  const height = layout.max.y - layout.min.y + 2;
  const now: Camera = camera ?? {
    x: (layout.min.x + layout.max.x) / 2,
    y: (layout.min.y + layout.max.y) / 2,
    scale: 1,
  };
  const box = {
    x: now.x - (width * now.scale) / 2,
    y: -now.y - (height * now.scale) / 2,
    width: width * now.scale,
    height: height * now.scale,
  };
  const metresAPixel = () => {
    const size = svg.current?.getBoundingClientRect();
    return size ? Math.max(box.width / size.width, box.height / size.height) : 0.05;
  };
  const [pane, setPane] = useState({ width: 0, height: 0 });
  useLayoutEffect(() => {
    const element = svg.current;
    if (!element) return;
    const measure = () => setPane({ width: element.clientWidth, height: element.clientHeight });
    measure();
    const observer = new ResizeObserver(measure);
    observer.observe(element);
    return () => observer.disconnect();
  }, []);
  const whole = pane.width > 0 && pane.height > 0 ? Math.max(width / pane.width, height / pane.height) : 0.04;
  const scale = Math.round(now.scale * 100) / 100; // names are placed anew in small steps
  const letters = useMemo(() => lettersAt(whole * scale, whole), [whole, scale]);
  const size = Math.max(0.32, 0.62 * Math.sqrt(now.scale)); // of a robot: seen from far, and not huge near by
  const people = placePeople(props.people, layout);
  const names = useMemo(() => namesOf(layout, letters), [layout, letters]);
  const labels = placeLabels(names, [
    ...props.robots
      .filter((r) => r.hasPose)
      .slice(0, labelsPlaced)
      .map((r) => ({ key: r.robot, x: r.xM, y: -r.yM, radius: size, text: r.label, size: letters.robot })),
    ...people.slice(0, labelsPlaced).map(({ person, at }) => ({
      key: person.iri,
      x: at.x,
      y: -at.y,
      radius: size * 0.42,
      text: person.name,
      size: letters.person,
    })),
  ]);
  return (
    <svg
      ref={svg}
      className={`hall-svg${props.tour ? " touring" : ""}`}
      viewBox={`${box.x} ${box.y} ${box.width} ${box.height}`}
      preserveAspectRatio="xMidYMid meet"
      role="group"
      aria-label="Map of the hall"
      onWheel={(e) => {
        const by = Math.exp(e.deltaY * 0.0012);
        const scale = Math.max(0.08, Math.min(1.6, now.scale * by));
        const rect = svg.current?.getBoundingClientRect();
        if (!rect) return;
        const m = metresAPixel();
        const dx = (e.clientX - rect.left - rect.width / 2) * m;
        const dy = -(e.clientY - rect.top - rect.height / 2) * m;
        const k = 1 - scale / now.scale;
        props.onCamera({ x: now.x + dx * k, y: now.y + dy * k, scale });
      }}
      onPointerDown={(e) => (drag.current = { x: e.clientX, y: e.clientY, camera: now, moved: false })}
      onPointerMove={(e) => {
        const d = drag.current;
        if (!d || e.buttons === 0) return;
        if (Math.hypot(e.clientX - d.x, e.clientY - d.y) < 4 && !d.moved) return;
        d.moved = true;
        const m = metresAPixel();
        props.onCamera({
          ...d.camera,
          x: d.camera.x - (e.clientX - d.x) * m,
          y: d.camera.y + (e.clientY - d.y) * m,
        });
      }}
      onClick={(e) => {
        const target = e.target instanceof Element ? e.target.closest("[data-iri]") : null;
        if (!drag.current?.moved) props.onPick(target?.getAttribute("data-iri") ?? "");
        drag.current = null;
      }}
    >
      <Shapes layout={layout} picked={props.picked} onPick={stablePick} />
      <Names layout={layout} letters={letters} />
      {[...props.trails].map(([iri, trail]) => (
        <polyline key={iri} className="hall-trail" points={trail.map((p) => `${p.x},${-p.y}`).join(" ")} />
      ))}
      {props.robots
        .filter((r) => r.hasPose)
        .map((r) => (
          <WayMark key={r.robot} way={props.ways.get(r.robot)} at={{ x: r.xM, y: r.yM }} />
        ))}
      {props.tour && (
        <polyline
          className="hall-tourline"
          points={props.tour.map((p) => `${p.x},${-p.y + 1.25}`).join(" ")}
        />
      )}
      {props.tour?.map((p, i) => (
        <g key={i} className="hall-tourstop" transform={`translate(${p.x} ${-p.y + 1.25})`}>
          <circle r={letters.stop * 0.93} />
          <text y={letters.stop * 0.36} fontSize={letters.stop}>
            {i + 1}
          </text>
        </g>
      ))}
      {people.map(({ person, at }) => (
        <g
          key={person.iri}
          className={`hall-person${props.picked === person.iri ? " picked" : ""}`}
          data-iri={person.iri}
          transform={`translate(${at.x} ${-at.y})`}
        >
          <circle r={size * 0.42} />
          <text
            {...labels.get(person.iri)}
            fontSize={letters.person}
            style={{ strokeWidth: letters.person * outline }}
          >
            {person.name}
          </text>
        </g>
      ))}
      {props.robots
        .filter((r) => r.hasPose)
        .map((r) => (
          <g
            key={r.robot}
            className={`hall-robot ${r.outOfService ? "maintenance" : r.state}${props.picked === r.robot ? " picked" : ""}`}
            data-iri={r.robot}
            tabIndex={0}
            role="button"
            aria-label={`Robot ${r.label}: ${r.state}, ${taskWords(r)}`}
            style={{ transform: `translate(${r.xM}px, ${-r.yM}px)` }}
            onKeyDown={(e) =>
              (e.key === "Enter" || e.key === " ") && (e.preventDefault(), props.onPick(r.robot))
            }
          >
            <circle className="hall-halo" r={size * 1.55} />
            <circle
              className="hall-deviation"
              r={(props.ways.get(r.robot)?.deviationM ?? 0) * shownDeviations}
            />
            <g transform={`rotate(${(-r.headingRad * 180) / Math.PI})`}>
              <circle className="hall-body" r={size} />
              <path
                className="hall-nose"
                d={`M${size * 0.15},${-size * 0.5} L${size * 0.72},0 L${size * 0.15},${size * 0.5}`}
              />
            </g>
            <text
              {...labels.get(r.robot)}
              fontSize={letters.robot}
              style={{ strokeWidth: letters.robot * outline }}
            >
              {r.label}
            </text>
          </g>
        ))}
    </svg>
  );
}

// The rest of a robot's way, to where it goes.
function WayMark({ way, at }: { way: Way | undefined; at: Point }) {
  const rest = way ? restOf(way.path, at) : [];
  const goal = rest.at(-1);
  if (!goal) return null;
  return (
    <g className="hall-way" aria-hidden>
      <polyline points={rest.map((p) => `${p.x},${-p.y}`).join(" ")} />
      <circle cx={goal.x} cy={-goal.y} r={0.22} />
    </g>
  );
}

const Shapes = memo(
  function Shapes({
    layout,
    picked,
    onPick,
  }: {
    layout: Layout;
    picked: string;
    onPick: (iri: string) => void;
  }) {
    return (
      <g>
        {layout.shapes.map((shape) => (
          <ShapeMark key={shape.iri} shape={shape} picked={picked === shape.iri} onPick={onPick} />
        ))}
      </g>
    );
  },
  (a, b) => a.layout === b.layout && a.picked === b.picked,
);

const Names = memo(function Names({ layout, letters }: { layout: Layout; letters: Letters }) {
  return (
    <g>
      {layout.shapes.filter(isNamed).map((s) => (
        <ShapeLabel key={s.iri} shape={s} letters={letters} />
      ))}
    </g>
  );
});

function ShapeMark({
  shape,
  picked,
  onPick,
}: {
  shape: Shape;
  picked: boolean;
  onPick: (iri: string) => void;
}) {
  const [first] = shape.rings;
  const selectable = shape.kind === "booth" || shape.kind === "region";
  const common = {
    className: `shape ${shape.kind}${picked ? " picked" : ""}`,
    ...(selectable && {
      "data-iri": shape.iri,
      tabIndex: 0,
      role: "button",
      "aria-label": [shape.name, shape.detail].filter(Boolean).join(", "),
      onKeyDown: (e: React.KeyboardEvent) =>
        void ((e.key === "Enter" || e.key === " ") && (e.preventDefault(), onPick(shape.iri))),
    }),
  };
  if (first?.length === 1 && first[0])
    return <circle {...common} cx={first[0].x} cy={-first[0].y} r={shape.radius} />;
  return (
    <path
      {...common}
      d={shape.rings.map((ring) => `M${ring.map((p) => `${p.x},${-p.y}`).join("L")}Z`).join("")}
    />
  );
}

// A name that has no room in its place is left out until it is nearer; a booth's number always stands.
export function linesOf(
  shape: Shape,
  letters: Letters,
): { name: { text: string; y: number; size: number }; lines: { text: string; y: number }[] } {
  const [xs, ys] = [shape.rings[0]?.map((p) => p.x) ?? [0], shape.rings[0]?.map((p) => p.y) ?? [0]];
  const [wide, high] = [Math.max(...xs) - Math.min(...xs), Math.max(...ys) - Math.min(...ys)];
  const size = shape.kind === "booth" ? letters.booth : letters.region;
  const room = Math.floor(wide / (letters.detail * letterWidth));
  const wanted = shape.kind === "booth" && shape.detail ? wrap(shape.detail, room) : [];
  const lines =
    wanted.every((line) => line.length <= room) && size * 1.3 + wanted.length * letters.detail * 1.2 < high
      ? wanted
      : [];
  const fits = shape.kind === "booth" || wide >= shape.name.length * size * letterWidth * 0.8;
  const top = -shape.label.y + (lines.length > 0 ? -size * 0.2 : size * 0.3);
  return {
    name: { text: fits ? shape.name : "", y: top, size },
    lines: lines.map((text, i) => ({ text, y: top + letters.detail * (1.25 + i * 1.2) })),
  };
}
const letterWidth = 0.56; // of their size
const isNamed = (shape: Shape) => shape.kind === "booth" || shape.kind === "region";

// What the names of places cover.
function namesOf(layout: Layout, letters: Letters): Box[] {
  return layout.shapes.filter(isNamed).flatMap((shape) => {
    const { name, lines } = linesOf(shape, letters);
    return [
      textBox(shape.label.x, name.y, name.text, name.size),
      ...lines.map((line) => textBox(shape.label.x, line.y, line.text, letters.detail)),
    ];
  });
}

function ShapeLabel({ shape, letters }: { shape: Shape; letters: Letters }) {
  if (!shape.rings[0]) return null;
  const { name, lines } = linesOf(shape, letters);
  return (
    <g className={`shape-label ${shape.kind}`} aria-hidden>
      <text x={shape.label.x} y={name.y} fontSize={name.size} style={{ strokeWidth: name.size * outline }}>
        {name.text}
      </text>
      {lines.map((line) => (
        <text
          key={line.y}
          className="shape-detail"
          x={shape.label.x}
          y={line.y}
          fontSize={letters.detail}
          style={{ strokeWidth: letters.detail * outline }}
        >
          {line.text}
        </text>
      ))}
    </g>
  );
}

function wrap(text: string, room: number): string[] {
  const lines: string[] = [];
  for (const word of text.split(" ")) {
    const last = lines.at(-1);
    if (last !== undefined && last.length + word.length + 1 <= room)
      lines[lines.length - 1] = `${last} ${word}`;
    else lines.push(word);
  }
  return lines.slice(0, 2);
}

// People stand where their pose is; who has none stands in the region, beside the others there.
function placePeople(people: readonly Person[], layout: Layout): { person: Person; at: Point }[] {
  const shapes = new Map(layout.shapes.map((s) => [s.iri, s]));
  const there = new Map<string, number>();
  return people.flatMap((person) => {
    if (person.x !== null && person.y !== null) return [{ person, at: { x: person.x, y: person.y } }];
    const ring = shapes.get(person.at)?.rings[0];
    if (!ring) return [];
    const n = there.get(person.at) ?? 0;
    there.set(person.at, n + 1);
    const at = centre(ring);
    return [
      {
        person,
        at: {
          x: at.x + 0.9 + Math.cos(n * 2.4) * 0.5 * Math.sqrt(n),
          y: at.y - 1 + Math.sin(n * 2.4) * 0.5 * Math.sqrt(n),
        },
      },
    ];
  });
}
