// A robot: what it does and for whom, what it can do, for whom it is kept, and what an operator does with it.
import { CalendarClock, X } from "lucide-react";
import { useState } from "react";
import { fleet } from "../api/client";
import type { Names } from "../api/prefixes";
import { localName } from "../api/sparql";
import { Link } from "../ui/link";
import { usePast } from "../api/past";
import { paths } from "../ui/router";
import { words } from "../cawl/names";
import type { RobotReservation, RobotStatus } from "../gen/docent/v1/fleet_pb";
import { ReserveDialog } from "./reserve_dialog";
import { taskWords } from "../hall/robot_words";
import { attempt } from "./run_actions";
import { ServiceDialog } from "./service_dialog";
import { clock, runWords } from "../ui/states";
import type { Way } from "../hall/ways";

export function RobotPanel({
  robot,
  way,
  names,
  again,
}: {
  robot: RobotStatus;
  way: Way | undefined;
  names: Names;
  again: () => void;
}) {
  const past = usePast() !== null;
  const [reserving, setReserving] = useState(false);
  const [taking, setTaking] = useState(false);
  const task = robot.heldFor[0];
  return (
    <>
      <p className="quiet">
        {taskWords(robot)}
        {task?.step ? `, step ${task.step}` : ""}
        {robot.heldBy && (
          <>
            {" "}
            for{" "}
            <Link href={paths.run(task?.run || robot.heldBy, task?.node ?? "")}>
              {runWords(task?.run || robot.heldBy)}
            </Link>
            {task?.run && task.run !== robot.heldBy && (
              <>
                , a part of <Link href={paths.run(robot.heldBy)}>{runWords(robot.heldBy)}</Link>
              </>
            )}
          </>
        )}
      </p>
      {robot.hasPose && (
        <p className="faint small number">
          {robot.xM.toFixed(2)} m, {robot.yM.toFixed(2)} m, {Math.round((robot.headingRad * 180) / Math.PI)}°
          {way?.deviationM != null && ` ± ${(way.deviationM * 2).toFixed(2)} m`}
        </p>
      )}
      {!past && (
        <div className="row">
          {robot.outOfService ? (
            <button
              className="button small"
              onClick={() =>
                attempt("The robot is in service", () => fleet.putInService({ robot: robot.robot }), again)
              }
            >
              Put in service
            </button>
          ) : (
            <button
              className="button small"
              title="It gets no further command"
              onClick={() => setTaking(true)}
            >
              Take out of service
            </button>
          )}
          <button className="button small" onClick={() => setReserving(true)}>
            <CalendarClock size={13} />
            Reserve
          </button>
        </div>
      )}
      {robot.reservations.length > 0 && (
        <>
          <h3>Kept</h3>
          <ul className="reservations">
            {robot.reservations.map((r) => (
              <Reservation key={r.reservation} reservation={r} names={names} again={again} fixed={past} />
            ))}
          </ul>
        </>
      )}
      {robot.capabilities.length > 0 && (
        <>
          <h3>Can do</h3>
          <p className="row tags">
            {robot.capabilities.map((c) => (
              <span key={c} className="tag accent" title={names.short(c) || c}>
                {words(localName(c))}
              </span>
            ))}
          </p>
        </>
      )}
      {robot.operations.length > 0 && (
        <>
          <h3>Operations</h3>
          <p className="row tags">
            {robot.operations.map((o) => (
              <span key={o} className="tag">
                {words(o)}
              </span>
            ))}
          </p>
        </>
      )}
      {taking && (
        <ServiceDialog
          robot={robot}
          name={robot.label || names.name(robot.robot)}
          again={again}
          onClose={() => setTaking(false)}
        />
      )}
      {reserving && (
        <ReserveDialog robot={robot} names={names} again={again} onClose={() => setReserving(false)} />
      )}
    </>
  );
}

function Reservation({
  reservation,
  names,
  again,
  fixed,
}: {
  reservation: RobotReservation;
  names: Names;
  again: () => void;
  fixed: boolean;
}) {
  const { keptFor, untilUs, priority, robots, reason } = reservation;
  return (
    <li className="reservation">
      <span className="grow">
        <b>{keptFor ? `for ${runWords(keptFor)}` : "for none"}</b>{" "}
        {untilUs > 0n ? `until ${clock(untilUs)}` : "until it is released"}
        <span className="faint small">
          {[
            priority !== 0 && `priority ${priority}`,
            robots.length > 1 && `with ${robots.length - 1} more`,
            reason,
          ]
            .filter(Boolean)
            .map((part) => `, ${part}`)
            .join("")}
        </span>
      </span>
      {!fixed && (
        <button
          className="button plain icon small"
          aria-label={`Release the reservation ${keptFor ? `for ${keptFor}` : "for none"}`}
          title={`Release ${names.name(reservation.reservation)}`}
          onClick={() =>
            attempt(
              "The reservation is released",
              () => fleet.release({ reservation: reservation.reservation }),
              again,
            )
          }
        >
          <X size={13} />
        </button>
      )}
    </li>
  );
}
