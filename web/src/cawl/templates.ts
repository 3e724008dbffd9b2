// Documents to begin with. Each is a whole workflow that the check takes.
import { encodeAttribute } from "./xml";

export interface Template {
  id: string;
  title: string;
  detail: string;
  text: (name: string) => string;
}

const open = (name: string) => `<?xml version="1.0" encoding="UTF-8"?>
<CAWL name="${encodeAttribute(name)}" version="1.0"
      xmlns:docent="https://w3id.org/docent#"
      xmlns:expo="https://w3id.org/docent/expo#"
      xmlns:ext="https://w3id.org/docent/cawl-ext#">
`;

const activatorFor = (flow: string) => `
  <activator name="OnChoice">
    <documentation>One run for each visitor who chooses the service.</documentation>
    <activate flow="${encodeAttribute(flow)}"/>
    <condition>
      <context name="Chosen">
        <rule name="choice">
          <constraint name="chose">
            <subject type="docent:Visitor">?user</subject>
            <verb>docent:chose</verb>
            <object>expo:${flow.replace(/[^A-Za-z0-9_]/g, "") || "My"}Service</object>
          </constraint>
        </rule>
      </context>
    </condition>
  </activator>
`;

export const templates: readonly Template[] = [
  {
    id: "empty",
    title: "Empty workflow",
    detail: "A beginning and an end. Add the steps between them.",
    text: (name) => `${open(name)}
  <flow name="${encodeAttribute(name)}">
    <source name="Begin"/>
    <sink name="End"/>
    <link from="Begin" to="End"/>
  </flow>
</CAWL>
`,
  },
  {
    id: "guide",
    title: "Guide a visitor",
    detail: "A robot comes to the visitor, leads the way to a booth, and presents it.",
    text: (name) => `${open(name)}${activatorFor(name)}
  <flow name="${encodeAttribute(name)}">
    <variable name="user" type="docent:Visitor"/>
    <variable name="robot" type="docent:Robot"/>
    <variable name="booth" type="docent:Booth"/>

    <source name="Arrived"/>

    <node name="Come to the visitor">
      <condition>
        <context name="RobotIsFree">
          <rule name="free">
            <constraint name="status">
              <subject type="docent:Robot">?robot</subject>
              <verb>docent:status</verb>
              <object>docent:Standby</object>
            </constraint>
          </rule>
        </context>
      </condition>
      <invoke operation="moveToUser"/>
    </node>

    <node name="Lead to the booth">
      <condition>
        <context name="BoothSelected">
          <rule name="selection">
            <constraint name="selected">
              <subject>$user</subject>
              <verb>docent:selected</verb>
              <object type="docent:Booth">?booth</object>
            </constraint>
          </rule>
        </context>
      </condition>
      <invoke operation="moveToBooth"/>
    </node>

    <node name="Present the booth">
      <condition>
        <context name="BothThere">
          <rule name="arrived">
            <constraint name="userThere">
              <subject>$user</subject>
              <verb>docent:isAt</verb>
              <object>$booth</object>
            </constraint>
          </rule>
        </context>
      </condition>
      <invoke operation="briefInformation"/>
    </node>

    <sink name="Presented"/>

    <link from="Arrived" to="Come to the visitor"/>
    <link from="Come to the visitor" to="Lead to the booth"/>
    <link from="Lead to the booth" to="Present the booth"/>
    <link from="Present the booth" to="Presented"/>
  </flow>
</CAWL>
`,
  },
  {
    id: "event",
    title: "Answer an event",
    detail: "Something happens, for example a doorbell, and a robot drives there.",
    text: (name) => `${open(name)}
  <activator name="OnBell">
    <activate flow="${encodeAttribute(name)}"/>
    <condition>
      <case name="rang">
        <event operation="doorbell"/>
      </case>
    </condition>
  </activator>

  <flow name="${encodeAttribute(name)}">
    <variable name="booth" type="docent:Booth">
      <initialize><from expression="expo:B01"/></initialize>
    </variable>

    <source name="Rang"/>
    <node name="Go there" ext:timeout="3min">
      <invoke operation="moveToBooth"/>
    </node>
    <sink name="Answered"/>

    <link from="Rang" to="Go there"/>
    <link from="Go there" to="Answered"/>
  </flow>
</CAWL>
`,
  },
];
