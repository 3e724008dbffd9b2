// The hall on a phone: booths to touch, the visitor, and the robot that comes.
import { Minus, Plus } from "lucide-react";
import { useRef, useState } from "react";
import { flushSync } from "react-dom";
import type { RobotStatus } from "../gen/docent/v1/fleet_pb";
import { placeLabels, textBox } from "../hall/label_places";
import type { Shape } from "../hall/layout";
import type { Place, Places } from "./places";
import { useWords } from "./words";

const nearest = 4; // times as large as the whole hall

export function VisitMap(props: {
  places: Places;
  offered?: readonly Place[];
  picked?: string;
  at?: Place | undefined;
  robot?: RobotStatus | undefined;
  onPick?: (place: Place) => void;
}) {
  const { say } = useWords();
  const { layout } = props.places;
  const box = `${layout.min.x - 0.6} ${-layout.max.y - 0.6} ${layout.max.x - layout.min.x + 1.2} ${layout.max.y - layout.min.y + 1.2}`;
  const offered = new Map(props.offered?.map((p) => [p.iri, p]));
  const labels = placeLabels(
    layout.shapes
      .filter((s) => s.kind === "booth")
      .map((s) => textBox(s.label.x, -s.label.y + 0.35, s.name, 1)),
    [
      ...(props.at
        ? [{ key: "you", x: props.at.at.x, y: -props.at.at.y, radius: 0.75, text: say("map.you"), size: 1.1 }]
        : []),
      ...(props.robot?.hasPose
        ? [
            {
              key: "robot",
              x: props.robot.xM,
              y: -props.robot.yM,
              radius: 0.85,
              text: props.robot.label,
              size: 1.1,
            },
          ]
        : []),
    ],
  );
  const [zoom, setZoom] = useState(1);
  const pane = useRef<HTMLDivElement>(null);
  const zoomTo = (next: number) => {
    const element = pane.current;
    // The middle of what is seen stays there.
    const middle = element
      ? {
          x: (element.scrollLeft + element.clientWidth / 2) / element.scrollWidth,
          y: (element.scrollTop + element.clientHeight / 2) / element.scrollHeight,
        }
      : null;
    flushSync(() => setZoom(Math.max(1, Math.min(nearest, next))));
    if (element && middle)
      element.scrollTo(
        middle.x * element.scrollWidth - element.clientWidth / 2,
        middle.y * element.scrollHeight - element.clientHeight / 2,
      );
  };
  return (
    <div className="visit-map-frame">
      <div className="visit-map-pane" ref={pane} tabIndex={zoom > 1 ? 0 : undefined}>
        <svg
          className="visit-map"
          viewBox={box}
          role="group"
          aria-label={say("map")}
          style={{ width: `${zoom * 100}%` }}
        >
          {layout.shapes.map((shape) => (
            <Mark
              key={shape.iri}
              shape={shape}
              place={offered.get(shape.iri)}
              picked={props.picked === shape.iri}
              onPick={props.onPick}
            />
          ))}
          {layout.shapes
            .filter((s) => s.kind === "booth")
            .map((s) => (
              <text key={s.iri} x={s.label.x} y={-s.label.y + 0.35} fontSize={1} aria-hidden>
                {s.name}
              </text>
            ))}
          {layout.shapes
            .filter((s) => s.kind === "region" && offered.has(s.iri))
            .map((s) => (
              <text
                key={s.iri}
                className="region"
                x={s.label.x}
                y={-s.label.y + 0.3}
                fontSize={0.85}
                aria-hidden
              >
                {s.name}
              </text>
            ))}
          {props.robot?.hasPose && props.at && (
            <line
              className="visit-way"
              x1={props.robot.xM}
              y1={-props.robot.yM}
              x2={props.at.at.x}
              y2={-props.at.at.y}
            />
          )}
          {props.at && (
            <g className="visit-you" transform={`translate(${props.at.at.x} ${-props.at.at.y})`}>
              <circle r={0.75} />
              <text {...labels.get("you")} fontSize={1.1}>
                {say("map.you")}
              </text>
            </g>
          )}
          {props.robot?.hasPose && (
            <g
              className="visit-robot"
              style={{ transform: `translate(${props.robot.xM}px, ${-props.robot.yM}px)` }}
            >
              <circle className="halo" r={1.5} />
              <circle r={0.85} />
              <text {...labels.get("robot")} fontSize={1.1}>
                {props.robot.label}
              </text>
            </g>
          )}
        </svg>
      </div>
      <div className="visit-zoom">
        <button aria-label={say("map.nearer")} disabled={zoom >= nearest} onClick={() => zoomTo(zoom * 1.5)}>
          <Plus size={20} aria-hidden />
        </button>
        <button aria-label={say("map.farther")} disabled={zoom <= 1} onClick={() => zoomTo(zoom / 1.5)}>
          <Minus size={20} aria-hidden />
        </button>
      </div>
    </div>
  );
}

function Mark({
  shape,
  place,
  picked,
  onPick,
}: {
  shape: Shape;
  place: Place | undefined;
  picked: boolean;
  onPick: ((place: Place) => void) | undefined;
}) {
  const touch =
    place && onPick
      ? {
          role: "button",
          tabIndex: 0,
          "aria-label": [place.name, place.detail].filter(Boolean).join(", "),
          "aria-pressed": picked,
          onClick: () => onPick(place),
          onKeyDown: (e: React.KeyboardEvent) =>
            void ((e.key === "Enter" || e.key === " ") && (e.preventDefault(), onPick(place))),
        }
      : {};
  const common = {
    className: `visit-shape ${shape.kind}${picked ? " picked" : ""}${place ? " offered" : ""}`,
    ...touch,
  };
  const first = shape.rings[0];
  if (first?.length === 1 && first[0])
    return <circle {...common} cx={first[0].x} cy={-first[0].y} r={shape.radius} />;
  return (
    <path
      {...common}
      d={shape.rings.map((ring) => `M${ring.map((p) => `${p.x},${-p.y}`).join("L")}Z`).join("")}
    />
  );
}
