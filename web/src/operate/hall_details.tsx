// What is known of a robot, person, booth or region of the hall: what it does and has, and its facts with their reasons.
import { Bot, Map as MapIcon, MonitorSmartphone, QrCode, User, X } from "lucide-react";
import { useShown } from "../api/as_of";
import type { Names } from "../api/prefixes";
import { query, type Row } from "../api/sparql";
import type { RobotStatus } from "../gen/docent/v1/fleet_pb";
import { Lately } from "./lately";
import type { Layout } from "../hall/layout";
import { tellsItself } from "../facts/no_robot";
import { RobotPanel } from "./robot_panel";
import { TellPlace } from "./tell_place";
import { usePast } from "../api/past";
import { RobotTag } from "../hall/robot_words";
import { screenAddress } from "./screen_address";
import type { Way } from "../hall/ways";
import { Fact } from "./why";

const nothingSaid = /^http:\/\/www\.w3\.org\/(2002\/07\/owl|2000\/01\/rdf-schema)#/;
// Facts of Docent's own words and of the documents' first; those of other vocabularies follow, and what says nothing is left out.
function readable(rows: readonly Row[]): Row[] {
  const rank = (iri: string) =>
    /^http:\/\/www\.w3\.org\/|^http:\/\/www\.opengis\.net\//.test(iri)
      ? 2
      : /^https?:\/\/schema\.org\//.test(iri)
        ? 1
        : 0;
  return rows
    .filter((row) => !(row["p"]?.text.endsWith("#type") && nothingSaid.test(row["o"]?.text ?? "")))
    .sort((a, b) => rank(a["p"]?.text ?? "") - rank(b["p"]?.text ?? ""));
}

export function Details(props: {
  iri: string;
  robots: readonly RobotStatus[];
  layout: Layout | undefined;
  way: Way | undefined;
  names: Names;
  asked: boolean; // the field of its place is to have the keys
  onAsked: () => void; // it has them
  onClose: () => void;
  again: () => void;
}) {
  const { iri, names } = props;
  const robot = props.robots.find((r) => r.robot === iri);
  const shape = props.layout?.shapes.find((s) => s.iri === iri);
  const facts = useShown(
    `facts ${iri}`,
    (asOf, signal) =>
      query(
        `SELECT ?p ?o { <${iri.replace(/[<>"{}|^\`\\\s]/g, "")}> ?p ?o FILTER(!isBlank(?o)) } ORDER BY ?p LIMIT 60`,
        signal,
        asOf,
      ),
    1500,
  );
  const word = (v: { kind: string; text: string; datatype?: string } | undefined) =>
    !v
      ? ""
      : v.kind === "iri"
        ? names.short(v.text) || `<${v.text}>`
        : /integer|decimal|boolean|double/.test(v.datatype ?? "")
          ? v.text
          : JSON.stringify(v.text);
  const pages =
    facts.data?.rows.filter((row) => row["p"]?.text === "https://w3id.org/docent#screenPage") ?? [];
  const screen = pages.map((row) => screenAddress(row["o"]?.text)).find((address) => address);
  const past = usePast() !== null;
  const here = props.robots.filter((r) => r.regions.includes(iri));
  return (
    <>
      <header className="properties-head">
        <span className={`hall-icon ${robot ? "robot" : shape ? "booth" : "person"}`}>
          {robot ? <Bot size={15} /> : shape ? <MapIcon size={15} /> : <User size={15} />}
        </span>
        <span className="grow cut" style={{ fontWeight: 600, fontSize: "var(--text-l)" }}>
          {robot?.label || shape?.name || names.name(iri)}
        </span>
        {robot && <RobotTag state={robot.outOfService ? "maintenance" : robot.state} />}
        <button className="button plain icon small" aria-label="Close" onClick={props.onClose}>
          <X size={15} />
        </button>
      </header>
      <div className="hall-details" tabIndex={0} aria-label="Details">
        {shape?.detail && <p className="quiet">{shape.detail}</p>}
        {robot && <RobotPanel robot={robot} way={props.way} names={names} again={props.again} />}
        {!past && !shape && !tellsItself(robot) && facts.data && facts.data.rows.length > 0 && (
          <TellPlace
            iri={iri}
            name={robot?.label || names.name(iri)}
            layout={props.layout}
            names={names}
            asked={props.asked}
            onAsked={props.onAsked}
            again={facts.again}
          />
        )}
        {shape && ["booth", "region"].includes(shape.kind) && (
          <p>
            <a
              className="button small"
              href={`/visit/code.svg?${new URLSearchParams({ at: names.short(iri) || iri, base: location.origin, label: shape.name })}`}
              target="_blank"
              rel="noreferrer"
            >
              <QrCode size={13} />
              Code for visitors’ phones
            </a>
          </p>
        )}
        {robot && screen && (
          <p>
            <a className="button small" href={screen} target="_blank" rel="noreferrer">
              <MonitorSmartphone size={13} />
              Its screen
            </a>
          </p>
        )}
        {here.length > 0 && (
          <p className="quiet">Here: {here.map((r) => r.label || names.name(r.robot)).join(", ")}</p>
        )}
        <Lately key={iri} iri={iri} />
        <h3>Facts</h3>
        {facts.error && !facts.data && <p className="faint small">{facts.error.title}</p>}
        <ul>
          {readable(facts.data?.rows ?? []).map((row) => {
            const fact = [names.short(iri) || `<${iri}>`, word(row["p"]), word(row["o"])];
            return <Fact key={fact.join(" ")} words={fact} names={names} short />;
          })}
        </ul>
      </div>
    </>
  );
}
