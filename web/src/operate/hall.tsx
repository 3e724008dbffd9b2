// The hall live: booths and regions from the graph, robots with pose, trail and task, people where they are.
import { Bot, LocateFixed, Map as MapIcon, Minus, Plus, Route, Unplug, User } from "lucide-react";
import { useEffect, useMemo, useRef, useState } from "react";
import { useAsOf, useKept } from "../api/as_of";
import { fleet } from "../api/client";
import { useFollow } from "../api/live";
import { useNames, type Names } from "../api/prefixes";
import { useCommands } from "../ui/commands";
import { usePast } from "../api/past";
import { navigate, paths } from "../ui/router";
import { ListRobotsReplySchema, type RobotStatus } from "../gen/docent/v1/fleet_pb";
import { Details } from "./hall_details";
import { broughtIntoView, HallDrawing, type Camera } from "../hall/hall_drawing";
import { type Layout, useLayout, usePeople } from "../hall/layout";
import { askRobots } from "../facts/past_robots";
import { RobotTag, taskWords } from "../hall/robot_words";
import { TourPanel } from "./tour_panel";
import { useWays, type Way } from "../hall/ways";
import { toast } from "../ui/toasts";
import { newTour, useTourDraft } from "./tour_draft";
import "../hall/hall.css";

export function useRobots() {
  const at = usePast();
  const now = useFollow(at === null ? "robots" : "", {
    call: "docent.v1.Fleet/List",
    request: {},
    reply: ListRobotsReplySchema,
    poll: (signal) => fleet.list({}, { signal }),
    everyMs: 50,
  });
  const then = useAsOf("robots", at, askRobots);
  return useKept("robots", at === null ? now : then);
}

export default function Hall({ picked }: { picked: string }) {
  const layout = useLayout();
  const robots = useRobots();
  const people = usePeople();
  const ways = useWays();
  const names = useNames();
  const [camera, setCamera] = useState<Camera | null>(null);
  const pickedIri = picked ? names.long(picked) : "";
  const [tour, setTour] = useTourDraft();
  const leaveTour = () => {
    if (tour && tour.stops.length > 0)
      toast("good", "The tour is left", tour.stops.map((s) => s.name).join(", "), {
        label: "Undo",
        run: () => setTour(tour),
      });
    setTour(null);
  };
  const past = usePast() !== null;
  const pickTour = (iri: string) => {
    const shape = layout.data?.shapes.find((s) => s.iri === iri && s.kind === "booth");
    if (shape && tour)
      setTour({
        ...tour,
        stops: [
          ...tour.stops,
          { iri, term: names.short(iri) || `<${iri}>`, name: shape.name, x: shape.label.x, y: shape.label.y },
        ],
      });
  };
  const pick = (iri: string) =>
    navigate(paths.hall(iri === pickedIri ? "" : iri && (names.short(iri) || iri)), true);
  // What was chosen in a list or by name comes into view on the map.
  const find = (iri: string) => {
    const robot = list.find((r) => r.robot === iri);
    const person = people.data?.find((p) => p.iri === iri);
    const shape = (at: string) => layout.data?.shapes.find((s) => s.iri === at)?.label;
    const at = robot
      ? robot.hasPose
        ? { x: robot.xM, y: robot.yM }
        : undefined
      : person && person.x !== null && person.y !== null
        ? { x: person.x, y: person.y }
        : (shape(person?.at ?? "") ?? shape(iri));
    if (at) setCamera((c) => broughtIntoView(c, layout.data, at));
    if (iri !== pickedIri) pick(iri);
  };
  const [asked, setAsked] = useState(""); // of whom somebody is about to tell the place
  const tellPlace = (iri: string) => {
    find(iri);
    setAsked(iri);
  };
  const trails = useTrails(robots.data?.robots, past);
  useEffect(() => void (document.title = "Hall – Docent"), []);
  const list = robots.data?.robots ?? noRobots;
  const drawn = useMemo(() => list.slice(0, drawnRobots), [list]);
  useCommands([
    { title: "Show the whole hall", group: "Hall", icon: LocateFixed, keys: "F", run: () => setCamera(null) },
    {
      title: "Nearer",
      group: "Hall",
      icon: Plus,
      keys: "+|=",
      run: () => setCamera((c) => zoomed(c, layout.data, 0.8)),
    },
    {
      title: "Farther",
      group: "Hall",
      icon: Minus,
      keys: "-",
      run: () => setCamera((c) => zoomed(c, layout.data, 1.25)),
    },
    { title: "Select nothing", group: "Hall", keys: "Escape", hidden: true, run: () => pick("") },
    {
      title: "New tour from the map",
      group: "Hall",
      icon: Route,
      keys: "T",
      words: "booths workflow",
      run: () => tour ?? setTour(newTour),
    },
    ...list.slice(0, drawnRobots).map((r) => ({
      title: `Show robot ${r.label || names.name(r.robot)}`,
      group: "Hall",
      icon: Bot,
      run: () => find(r.robot),
    })),
    ...(past
      ? []
      : (people.data ?? []).slice(0, 100).map((p) => ({
          title: `${p.name || names.name(p.iri)} is at…`,
          group: "Hall",
          icon: User,
          words: "tell place where",
          run: () => tellPlace(p.iri),
        }))),
    ...(layout.data?.shapes ?? [])
      .filter((s) => ["booth", "region"].includes(s.kind))
      .map((s) => ({
        title: `Show ${s.name}`,
        group: "Hall",
        icon: MapIcon,
        words: s.detail,
        run: () => find(s.iri),
      })),
  ]);
  const empty = layout.data?.shapes.length === 0 && list.length === 0;
  return (
    <main className="page hall">
      <h1 className="unseen">Hall</h1>
      <div className="hall-stage">
        {layout.error && !layout.data && (
          <div className="nothing">
            <Unplug size={28} />
            <h2>{layout.error.title}</h2>
            <p>{layout.error.detail}</p>
          </div>
        )}
        {empty && (
          <div className="nothing">
            <MapIcon size={28} />
            <h2>No hall is described yet</h2>
            <p>
              Load a description of the place, with geometries of its regions:{" "}
              <code>docent load hall.ttl</code>. Robots appear when their adapters join.
            </p>
          </div>
        )}
        {layout.data && !empty && (
          <HallDrawing
            layout={layout.data}
            robots={drawn}
            people={people.data ?? []}
            trails={trails}
            ways={ways.data ?? noWays}
            picked={pickedIri}
            camera={camera}
            onCamera={setCamera}
            onPick={tour ? pickTour : pick}
            {...(tour && { tour: tour.stops })}
          />
        )}
        {!tour && !past && layout.data && layout.data.shapes.some((s) => s.kind === "booth") && (
          <button
            className="button hall-tour"
            title="Booths in order become a workflow (T)"
            onClick={() => setTour(newTour)}
          >
            <Route size={14} />
            New tour
          </button>
        )}
        <div className="hall-zoom">
          <button
            className="button icon"
            aria-label="Nearer"
            onClick={() => setCamera((c) => zoomed(c, layout.data, 0.8))}
          >
            <Plus size={15} />
          </button>
          <button
            className="button icon"
            aria-label="Farther"
            onClick={() => setCamera((c) => zoomed(c, layout.data, 1.25))}
          >
            <Minus size={15} />
          </button>
          <button
            className="button icon"
            aria-label="Show the whole hall"
            title="Show the whole hall (F)"
            onClick={() => setCamera(null)}
          >
            <LocateFixed size={15} />
          </button>
        </div>
      </div>
      <aside className="dock hall-side" aria-label="Robots and people">
        {tour ? (
          <TourPanel
            tour={tour}
            from={list[0]?.hasPose ? { x: list[0].xM, y: list[0].yM } : null}
            names={names}
            onChange={setTour}
            onMade={() => setTour(null)}
            onClose={leaveTour}
          />
        ) : pickedIri ? (
          <Details
            key={pickedIri}
            way={ways.data?.get(pickedIri)}
            iri={pickedIri}
            robots={list}
            layout={layout.data}
            names={names}
            asked={asked === pickedIri}
            onAsked={() => setAsked("")}
            onClose={() => pick("")}
            again={robots.again}
          />
        ) : (
          <>
            <h2 className="hall-title">
              Robots <span className="faint number">{list.length}</span>
            </h2>
            {list.length === 0 && (
              <p className="faint small hall-hint">
                {robots.error ? robots.error.title : "None has joined. Start one: docent-robot."}
              </p>
            )}
            <ul>
              {list.slice(0, listedRobots).map((r) => (
                <RobotRow key={r.robot} robot={r} names={names} onPick={find} />
              ))}
            </ul>
            {list.length > listedRobots && (
              <p className="faint small hall-hint">
                and {list.length - listedRobots} more: Ctrl-K finds a robot by its name
                {list.length > drawnRobots ? `; the map draws the first ${drawnRobots}` : ""}.
              </p>
            )}
            <h2 className="hall-title">
              People <span className="faint number">{people.data?.length ?? 0}</span>
            </h2>
            <ul>
              {(people.data ?? []).slice(0, 100).map((p) => (
                <li key={p.iri}>
                  <button className="hall-row" onClick={() => find(p.iri)}>
                    <span className="hall-icon person">
                      <User size={14} />
                    </span>
                    <span className="grow cut">
                      <b>{p.name || names.name(p.iri)}</b>
                      <span className="faint small">{p.at ? `at ${names.name(p.at)}` : "somewhere"}</span>
                    </span>
                  </button>
                </li>
              ))}
            </ul>
          </>
        )}
      </aside>
    </main>
  );
}

function zoomed(camera: Camera | null, layout: Layout | undefined, by: number): Camera | null {
  const now =
    camera ??
    (layout
      ? { x: (layout.min.x + layout.max.x) / 2, y: (layout.min.y + layout.max.y) / 2, scale: 1 }
      : null);
  return now && { ...now, scale: Math.max(0.08, Math.min(1.6, now.scale * by)) };
}

const noRobots: RobotStatus[] = [];
const listedRobots = 100;
const drawnRobots = 1000;
const noWays: ReadonlyMap<string, Way> = new Map();
const trailPoints = 240;
const leapM = 4;

// Of now, or of the past as far as it was played; a leap begins another one.
function useTrails(
  robots: readonly RobotStatus[] | undefined,
  past: boolean,
): ReadonlyMap<string, { x: number; y: number }[]> {
  const trails = useRef(new Map<string, { x: number; y: number }[]>());
  const ofPast = useRef(past);
  return useMemo(() => {
    if (ofPast.current !== past) trails.current.clear();
    ofPast.current = past;
    for (const r of robots ?? []) {
      if (!r.hasPose) continue;
      const trail = trails.current.get(r.robot) ?? [];
      const last = trail.at(-1);
      const far = last ? Math.hypot(last.x - r.xM, last.y - r.yM) : 0;
      if (!last || far > 0.08)
        trails.current.set(r.robot, [
          ...(past && far > leapM ? [] : trail.slice(-trailPoints)),
          { x: r.xM, y: r.yM },
        ]);
    }
    return new Map(trails.current);
  }, [robots, past]);
}

function RobotRow({
  robot,
  names,
  onPick,
}: {
  robot: RobotStatus;
  names: Names;
  onPick: (iri: string) => void;
}) {
  return (
    <li>
      <button className="hall-row" onClick={() => onPick(robot.robot)}>
        <span className="hall-icon robot">
          <Bot size={14} />
        </span>
        <span className="grow cut">
          <b>{robot.label || names.name(robot.robot)}</b>
          <span className="faint small cut">
            {[taskWords(robot), robot.regions[0] && `at ${names.name(robot.regions[0])}`]
              .filter(Boolean)
              .join(", ")}
          </span>
        </span>
        <RobotTag state={robot.outOfService ? "maintenance" : robot.state} />
      </button>
    </li>
  );
}
