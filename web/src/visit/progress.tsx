// How far the visitor's service is: where the robot is and when it comes, why it has to wait, and what the visitor can do.
import { Bot, CheckCircle2, CircleAlert, Hourglass, MapPin } from "lucide-react";
import { useEffect, useEffectEvent, useRef, useState } from "react";
import { localName } from "../api/sparql";
import type { RobotStatus } from "../gen/docent/v1/fleet_pb";
import { choose } from "./address";
import { etaWords, metresTo, secondsInQueue, secondsToGo, type Sighting, withSighting } from "./estimate";
import { Feedback } from "./feedback";
import { clockOf, type Journey, journeyOf, type Naming, type Reason, type Sentence } from "./journey";
import { useMyRun } from "./my_run";
import type { Offer } from "./offers";
import { PlacePicker } from "./place_picker";
import { type Place, type Places, placeWords } from "./places";
import { VisitMap } from "./visit_map";
import { arrive, change, end, select, useOutbox, useVisitor, withdraw } from "./visitor";
import { useWords } from "./words";

export function Progress({ places, offers }: { places: Places; offers: readonly Offer[] }) {
  const { say } = useWords();
  const visitor = useVisitor();
  const box = useOutbox();
  const mine = useMyRun();
  const place = (iri: string) => places.list.find((p) => p.iri === iri);
  const naming: Naming = {
    place: (iri) => {
      const p = place(iri);
      return p ? placeWords(p) : "";
    },
    robot: (iri) => mine.robots.find((r) => r.robot === iri)?.label ?? "",
    property: (iri) => localName(iri),
    clock: clockOf,
  };
  const journey =
    mine.run &&
    journeyOf(
      mine.run,
      mine.waits,
      mine.robots,
      { visitor: visitor.id, at: visitor.at, booth: visitor.booth, met: visitor.met === mine.run.id },
      naming,
    );
  const phase = journey?.phase;
  useEffect(() => {
    if (
      mine.run &&
      (phase === "here" || phase === "ahead" || phase === "presenting" || phase === "guiding") &&
      visitor.met !== mine.run.id
    )
      change({ met: mine.run.id });
  }, [phase, mine.run, visitor.met]);
  const ended = phase === "done" || phase === "failed" || phase === "cancelled";
  const [over, setOver] = useState<{ journey: Journey; run: string } | null>(null);
  const showEnd = useEffectEvent(() => {
    if (journey && mine.run) setOver({ journey, run: mine.run.id });
  });
  useEffect(() => {
    if (ended) showEnd();
  }, [ended]);
  const offer = offers.find((o) => o.iri === visitor.service);
  if (over) return <Over journey={over.journey} run={over.run} reason={mine.run?.reason ?? ""} />;
  return (
    <>
      <section className={`visit-status ${phase ?? "asked"}`} aria-live="polite">
        <span className="visit-status-icon">
          {phase === "staff" ? (
            <CircleAlert size={26} aria-hidden />
          ) : phase === "waiting" || !phase ? (
            <Hourglass size={26} aria-hidden />
          ) : (
            <Bot size={26} aria-hidden />
          )}
        </span>
        <div className="grow">
          {offer && (
            <p className="visit-what">
              {offer.name}
              {visitor.booth && naming.place(visitor.booth) && ` · ${naming.place(visitor.booth)}`}
            </p>
          )}
          <h2>
            {box.kind === "unsent"
              ? say("status.unsent")
              : box.kind === "refused"
                ? say("status.refused", { reason: box.reason })
                : !journey
                  ? say(box.kind === "sending" ? "status.sending" : visitor.run ? "loading" : "status.asked")
                  : statusWords(journey, say, naming, visitor.booth)}
          </h2>
          {journey && (
            <When
              journey={journey}
              at={place(visitor.at)}
              booth={place(visitor.booth)}
              before={mine.before}
              tookS={mine.tookS}
            />
          )}
        </div>
      </section>
      {journey &&
        journey.reasons.length > 0 &&
        ["waiting", "here", "ahead", "staff"].includes(journey.phase) && (
          <Reasons reasons={journey.reasons} places={places} booth={place(visitor.booth)} />
        )}
      <VisitMap places={places} at={place(visitor.at)} robot={journey?.robot} picked={visitor.booth} />
      <EndButton />
    </>
  );
}

function statusWords(
  journey: Journey,
  say: ReturnType<typeof useWords>["say"],
  naming: Naming,
  booth: string,
): string {
  const robot = journey.robot?.label || localName(journey.robot?.robot ?? "");
  return say(`status.${journey.phase}`, {
    robot,
    booth: naming.place(booth),
    place: naming.place(booth),
    reason: "",
  });
}

// When the robot is there: by its way where it is on its way, else by who is before.
function When({
  journey,
  at,
  booth,
  before,
  tookS,
}: {
  journey: Journey;
  at: Place | undefined;
  booth: Place | undefined;
  before: number;
  tookS: readonly number[];
}) {
  const { say } = useWords();
  const seen = useSightings(journey.robot);
  const words = (s: Sentence) => say(s.word, s.values);
  const target = journey.phase === "coming" ? at : journey.phase === "guiding" ? booth : undefined;
  if (target && journey.robot?.hasPose) {
    const from = { x: journey.robot.xM, y: journey.robot.yM };
    return (
      <p className="visit-eta">
        <b>{words(etaWords(secondsToGo(from, target.at, seen)))}</b> ·{" "}
        {say("eta.way", { metres: Math.max(1, Math.round(metresTo(from, target.at))) })}
      </p>
    );
  }
  if (journey.phase !== "waiting" || before === 0) return null;
  // A time is told only where those before are all that the visitor waits for.
  const occupied =
    journey.reasons.length > 0 &&
    journey.reasons.every((r) => r.word === "why.busy" || r.word === "why.ending");
  const seconds = occupied ? secondsInQueue(before, tookS) : null;
  return (
    <p className="visit-eta">
      <b>{before === 1 ? say("queue.one") : say("queue.many", { count: before })}</b>
      {seconds !== null && seconds > 0 && ` · ${words(etaWords(seconds))}`}
    </p>
  );
}

function useSightings(robot: RobotStatus | undefined): readonly Sighting[] {
  const seen = useRef<{ robot: string; list: Sighting[] }>({ robot: "", list: [] });
  if (robot?.hasPose) {
    const before = seen.current.robot === robot.robot ? seen.current.list : [];
    seen.current = {
      robot: robot.robot,
      list: withSighting(before, { x: robot.xM, y: robot.yM, ms: Date.now() }),
    };
  }
  return seen.current.list;
}

function Reasons({
  reasons,
  places,
  booth,
}: {
  reasons: readonly Reason[];
  places: Places;
  booth: Place | undefined;
}) {
  const { say } = useWords();
  const asksBooth = reasons.some((r) => r.remedy === "booth");
  return (
    <section className="visit-why" aria-labelledby="why-title">
      <h3 id="why-title">{say(reasons.every((r) => r.remedy) ? "next.title" : "why.title")}</h3>
      <ul>
        {reasons.map((r) => (
          <li key={`${r.word} ${JSON.stringify(r.values ?? {})}`}>{say(r.word, r.values)}</li>
        ))}
      </ul>
      {reasons.some((r) => r.remedy === "place") && (
        <button className="visit-second" onClick={() => choose({ step: "at" })}>
          <MapPin size={17} aria-hidden />
          {say("where.title")}
        </button>
      )}
      {reasons.some((r) => r.remedy === "here") && booth && (
        <button className="visit-main" onClick={() => arrive(booth.iri)}>
          <MapPin size={19} aria-hidden />
          {say("here", { place: booth.name })}
        </button>
      )}
      {asksBooth && (
        <PlacePicker
          title={say("booth.title")}
          places={places}
          list={places.list.filter((p) => p.booth)}
          picked=""
          onPick={(place) => select(place.iri)}
        />
      )}
    </section>
  );
}

const sureMs = 700;
function EndButton() {
  const { say } = useWords();
  const [asking, setAsking] = useState(false);
  const [shownMs] = useState(() => Date.now());
  // The second touch of a double one, on what was there before, is not meant for this.
  if (!asking)
    return (
      <button className="visit-second end" onClick={() => Date.now() - shownMs > sureMs && setAsking(true)}>
        {say("cancel")}
      </button>
    );
  return (
    <section className="visit-ask" role="alertdialog" aria-labelledby="end-title">
      <h3 id="end-title">{say("cancel.title")}</h3>
      <p>{say("cancel.text")}</p>
      <div className="visit-tools">
        <button className="visit-second" autoFocus onClick={() => setAsking(false)}>
          {say("cancel.no")}
        </button>
        <button className="visit-second bad" onClick={() => void end()}>
          {say("cancel.yes")}
        </button>
      </div>
    </section>
  );
}

function Over({ journey, run, reason }: { journey: Journey; run: string; reason: string }) {
  const { say } = useWords();
  const visitor = useVisitor();
  return (
    <>
      <section className={`visit-status ${journey.phase}`} aria-live="polite">
        <span className="visit-status-icon">
          {journey.phase === "failed" ? (
            <CircleAlert size={26} aria-hidden />
          ) : (
            <CheckCircle2 size={26} aria-hidden />
          )}
        </span>
        <h2 className="grow">
          {say(`status.${journey.phase}`, { reason, robot: "", booth: "", place: "" })}
        </h2>
      </section>
      <Feedback run={run} given={visitor.rated === run} />
      <button
        className={visitor.rated === run ? "visit-main" : "visit-second end"}
        onClick={() => (withdraw(), choose({ service: "", booth: "", step: "" }, true))}
      >
        {say("again")}
      </button>
    </>
  );
}
