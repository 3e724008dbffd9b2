// The frame around all views: where to go, what can be done (Ctrl-K), the keys (?), and whether the server is there.
import {
  Command as CommandIcon,
  ConciergeBell,
  Keyboard,
  Link as LinkIcon,
  ListChecks,
  Map as MapIcon,
  Megaphone,
  Moon,
  Sun,
  Timer,
  Unplug,
  Workflow,
} from "lucide-react";
import { lazy, Suspense, useRef, useState } from "react";
import { useServerClock } from "../api/clock";
import { useConnection } from "../api/connection";
import { usePollLabels } from "../api/labels";
import { usePoll } from "../api/poll";
import { fleet } from "../api/client";
import { useNames } from "../api/prefixes";
import { iriTerm } from "../api/terms";
import { create } from "@bufbuild/protobuf";
import { QuadSchema } from "../gen/docent/v1/term_pb";
import { Toasts, toast } from "../ui/toasts";
import { useCommands } from "../ui/commands";
import { CommandPalette } from "./command_palette";
import { Guard } from "../ui/guard";
import { KeysDialog } from "./keys_dialog";
import { Link } from "../ui/link";
import { usePast } from "../api/past";
import { navigate, paths, useRoute, type Route } from "../ui/router";
import { Time } from "../api/times";
import { themeShown, toggleTheme, useTheme } from "../ui/theme";
import "./shell.css";

const Documents = lazy(() => import("../compose/documents"));
const Compose = lazy(() => import("../compose/compose"));
const Runs = lazy(() => import("../operate/runs"));
const RunPage = lazy(() => import("../operate/run_page"));
const Hall = lazy(() => import("../operate/hall"));
const Board = lazy(() => import("../operate/board"));
const Desk = lazy(() => import("../desk/desk"));
const TellDialog = lazy(() => import("../facts/tell").then((m) => ({ default: m.TellDialog })));
const WaitingCount = lazy(() =>
  import("../operate/waiting_count").then((m) => ({ default: m.WaitingCount })),
);
const TimeBar = lazy(() => import("../operate/time_bar"));

const places = [
  { title: "Compose", path: paths.documents, icon: Workflow, views: ["documents", "compose"] },
  { title: "Runs", path: paths.runs, icon: ListChecks, views: ["runs", "run"] },
  { title: "Hall", path: paths.hall, icon: MapIcon, views: ["hall"] },
  { title: "Waiting", path: paths.board, icon: Timer, views: ["board"] },
  { title: "Desk", path: paths.desk, icon: ConciergeBell, views: ["desk"] },
];
const isAtFact = create(QuadSchema, { predicate: iriTerm("https://w3id.org/docent#isAt") }); // told most often
const timed = ["hall", "runs", "board", "run"]; // views that can show the past

export function App() {
  const view = useRef<HTMLDivElement>(null);
  const route = useRoute();
  const theme = useTheme();
  usePast(); // links take the time along
  useServerClock();
  usePollLabels();
  const names = useNames();
  const [open, setOpen] = useState<"commands" | "keys" | "tell" | null>(null);
  useCommands([
    ...places.map((place) => ({
      title: `Go to ${place.title}`,
      group: "Go to",
      icon: place.icon,
      keys: `G ${place.title[0]}`,
      run: () => navigate(place.path()),
    })),
    {
      title: "Tell a fact…",
      words: "visitor person robot is at place knowledge say assert",
      group: "Everywhere",
      icon: Megaphone,
      run: () => setOpen("tell"),
    },
    {
      title: "All commands",
      group: "Everywhere",
      keys: "Mod+K",
      inFields: true,
      hidden: true,
      run: () => setOpen("commands"),
    },
    { title: "Show the keys", group: "Everywhere", icon: Keyboard, keys: "?", run: () => setOpen("keys") },
    {
      title: themeShown() === "dark" ? "Light colours" : "Dark colours",
      words: "theme mode",
      group: "Everywhere",
      icon: theme === "dark" ? Sun : Moon,
      run: toggleTheme,
    },
    {
      title: "Copy the link to this view",
      words: "url share address",
      group: "Everywhere",
      icon: LinkIcon,
      run: copyLink,
    },
  ]);
  return (
    <div className="shell">
      <a className="skip" href="#view" onClick={(e) => (e.preventDefault(), view.current?.focus())}>
        Skip the menu
      </a>
      <nav className="rail" aria-label="Views">
        <Link className="rail-mark" href={paths.documents()} aria-label="Docent, all workflows">
          <img src="/icon.svg" alt="" />
        </Link>
        {places.map((place) => (
          <Link
            key={place.title}
            href={place.path()}
            aria-current={place.views.includes(route.view) ? "page" : undefined}
          >
            <place.icon size={18} strokeWidth={1.8} />
            {place.title}
            {place.title === "Waiting" && (
              <Suspense>
                <WaitingCount />
              </Suspense>
            )}
          </Link>
        ))}
        <span className="rail-space" />
        <button
          className="rail-small"
          onClick={() => setOpen("commands")}
          aria-label="All commands"
          title="All commands (Ctrl-K)"
        >
          <CommandIcon size={16} />
        </button>
        <button className="rail-small" onClick={() => setOpen("keys")} aria-label="Keys" title="Keys (?)">
          <Keyboard size={17} />
        </button>
        <button
          className="rail-small"
          onClick={toggleTheme}
          aria-label={theme === "dark" ? "Light colours" : "Dark colours"}
          title="Light or dark"
        >
          {theme === "dark" ? <Sun size={16} /> : <Moon size={16} />}
        </button>
      </nav>
      <div className="page" id="view" ref={view} tabIndex={-1}>
        <Stale />
        <Guard key={routeKey(route)}>
          <Suspense fallback={<div className="view" aria-busy="true" />}>
            <View route={route} />
          </Suspense>
        </Guard>
        {timed.includes(route.view) && (
          <Suspense>
            <TimeBar run={route.view === "run" ? route.run : ""} />
          </Suspense>
        )}
      </div>
      {open === "commands" && <CommandPalette onClose={() => setOpen(null)} />}
      {open === "tell" && (
        <Suspense>
          <TellDialog
            title="Tell a fact"
            quads={[isAtFact]}
            patterns={[]}
            names={names}
            onClose={() => setOpen(null)}
          />
        </Suspense>
      )}
      {open === "keys" && <KeysDialog onClose={() => setOpen(null)} />}
      <Toasts />
    </div>
  );
}

function routeKey(route: Route): string {
  return route.view === "compose"
    ? `compose ${route.name}`
    : route.view === "run"
      ? `run ${route.run}`
      : route.view;
}

function View({ route }: { route: Route }) {
  switch (route.view) {
    case "documents":
      return <Documents />;
    case "compose":
      return (
        <Compose name={route.name} flow={route.flow} step={route.step} via={route.via} trial={route.trial} />
      );
    case "runs":
      return <Runs state={route.state} workflow={route.workflow} />;
    case "run":
      return <RunPage id={route.run} node={route.node} />;
    case "hall":
      return <Hall picked={route.picked} />;
    case "board":
      return <Board />;
    case "desk":
      return <Desk search={route.search} />;
    case "unknown":
      return (
        <main className="view nothing">
          <h1>There is no view at {route.path}</h1>
          <p>
            The address may be mistyped, or from another version.{" "}
            <Link href={paths.documents()}>Go to the workflows</Link>.
          </p>
        </main>
      );
  }
}

// Says that what is shown may be old, as long as the server is silent. Asks it until it is back.
function Stale() {
  const connection = useConnection();
  usePoll(connection.state === "away" ? "away" : "", (signal) => fleet.list({}, { signal }), 1500);
  if (connection.state !== "away") return null;
  return (
    <div className="stale" role="status">
      <Unplug size={14} />
      <span>
        The server has not answered since <Time us={BigInt(connection.since) * 1000n} />. What you see may be
        old; what you write is kept here.
      </span>
    </div>
  );
}

function copyLink() {
  navigator.clipboard.writeText(window.location.href).then(
    () => toast("good", "The link is copied", window.location.href),
    () => toast("bad", "The link could not be copied", window.location.href),
  );
}
