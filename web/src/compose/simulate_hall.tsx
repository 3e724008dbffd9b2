// A small map of the hall with the robots that drive in a simulation. The list of what happens says the same in words.
import { create } from "@bufbuild/protobuf";
import { RobotStatusSchema } from "../gen/docent/v1/fleet_pb";
import type { SimulatedPose } from "../gen/docent/v1/replays_pb";
import { HallDrawing } from "../hall/hall_drawing";
import { useLayout } from "../hall/layout";
import { placesAt } from "./simulation";
import { robotName } from "./simulation_words";
import "../hall/hall.css";

const none = new Map<string, never>();
const nothing = () => undefined;

export function SimulateHall({ poses, atS }: { poses: readonly SimulatedPose[]; atS: number }) {
  const layout = useLayout();
  if (!layout.data || layout.data.shapes.length === 0) return null;
  const robots = [...placesAt(poses, atS)].map(([robot, at]) =>
    create(RobotStatusSchema, {
      robot,
      label: robotName(robot),
      hasPose: true,
      xM: at.x,
      yM: at.y,
      headingRad: at.heading,
      state: at.driving ? "busy" : "standby",
    }),
  );
  return (
    <div className="simulate-hall" inert>
      <HallDrawing
        layout={layout.data}
        robots={robots}
        people={[]}
        trails={none}
        ways={none}
        picked=""
        camera={null}
        onCamera={nothing}
        onPick={nothing}
      />
    </div>
  );
}
