// What an operator can do where a robot is the cause that something waits: look at it, put it in service, give the run another one.
import { Bot, MapPin, Power, X } from "lucide-react";
import { useState } from "react";
import { fleet, workflows } from "../api/client";
import { usePast } from "../api/past";
import type { Names } from "../api/prefixes";
import { iriTerm } from "../api/terms";
import { Link } from "../ui/link";
import { paths } from "../ui/router";
import type { RobotStatus } from "../gen/docent/v1/fleet_pb";
import { type Node, type Run, SettleRequest_How } from "../gen/docent/v1/workflows_pb";
import { Dialog } from "../ui/dialog";
import { exchangeOf, fitFor } from "./exchange";
import { whyNotReady } from "../facts/no_robot";
import { RobotTag } from "../hall/robot_words";
import { attempt } from "./run_actions";
import { runWords } from "../ui/states";

const robotsWithButtons = 4;

// `causes`: IRIs of robots.
export function CauseActions({
  causes,
  robots,
  names,
  again,
}: {
  causes: readonly string[];
  robots: readonly RobotStatus[];
  names: Names;
  again: () => void;
}) {
  const past = usePast() !== null;
  const known = causes
    .slice(0, robotsWithButtons)
    .flatMap((iri) => robots.find((r) => r.robot === iri) ?? []);
  if (known.length === 0) return null;
  return (
    <div className="row cause-actions">
      {known.map((r) => {
        const name = r.label || names.name(r.robot);
        return (
          <span key={r.robot} className="row">
            {r.outOfService && !past && (
              <button
                className="button small"
                onClick={() =>
                  attempt(`${name} is in service`, () => fleet.putInService({ robot: r.robot }), again)
                }
              >
                <Power size={13} />
                Put {name} in service
              </button>
            )}
            <Link
              className="button small"
              href={paths.hall(names.short(r.robot) || r.robot)}
              title={`Where ${name} is, and what it does`}
            >
              <MapPin size={13} />
              {known.length === 1 ? "See it in the hall" : `See ${name} in the hall`}
            </Link>
          </span>
        );
      })}
    </div>
  );
}

// For a step that waits for one robot of its run, or failed and can be done by another one.
export function AnotherRobot({
  run,
  node,
  runs,
  causes,
  robots,
  names,
  again,
}: {
  run: Run;
  node: Node | undefined;
  runs: readonly Run[];
  causes: readonly string[];
  robots: readonly RobotStatus[];
  names: Names;
  again: () => void;
}) {
  const [asking, setAsking] = useState(false);
  const past = usePast() !== null;
  const exchange = node && !past ? exchangeOf(run, node, runs, causes) : null;
  const fitting = exchange ? fitFor(exchange, robots) : [];
  if (!node || !exchange || fitting.length === 0) return null;
  const give = (robot: RobotStatus) => {
    setAsking(false);
    const name = robot.label || names.name(robot.robot);
    const calls = async () => {
      if (exchange.how === "retry")
        await workflows.settle({
          run: run.id,
          node: node.name,
          how: SettleRequest_How.RETRY,
          robot: robot.robot,
        });
      else
        for (const one of exchange.values)
          await workflows.setVariable({
            run: one.run,
            variable: { name: one.name, value: iriTerm(robot.robot) },
          });
    };
    attempt(
      exchange.how === "retry" ? `The step begins again with ${name}` : `The run waits for ${name} now`,
      calls,
      again,
    );
  };
  return (
    <>
      <button className="button small" onClick={() => setAsking(true)}>
        <Bot size={13} />
        {exchange.how === "retry" ? "Try again with another robot" : "Give the run another robot"}
      </button>
      {asking && (
        <Dialog label="Another robot" width={440} onClose={() => setAsking(false)}>
          <div className="sheet-head">
            <h2 className="grow">Another robot for {runWords(run.id)}</h2>
            <button className="button plain icon small" aria-label="Close" onClick={() => setAsking(false)}>
              <X size={15} />
            </button>
          </div>
          <div className="sheet-body" style={{ display: "grid", gap: "var(--space-3)" }}>
            <p className="quiet">
              {exchange.how === "retry"
                ? `${node.name} begins again with the robot that you choose.`
                : `${node.name} and what comes after it wait for the robot that you choose.`}
            </p>
            {fitting.map((r) => (
              <button key={r.robot} className="button robot-choice" onClick={() => give(r)}>
                <Bot size={13} />
                <b>{r.label || names.name(r.robot)}</b>
                <span className="grow faint small cut">{whyNotReady(r, run.id) || "is free"}</span>
                <RobotTag state={r.outOfService ? "maintenance" : r.state} />
              </button>
            ))}
          </div>
        </Dialog>
      )}
    </>
  );
}
