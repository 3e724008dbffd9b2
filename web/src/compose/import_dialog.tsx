// Steps from services elsewhere: a WSDL text or file, a gRPC server, a robot's adapter.
import { CircleAlert, FileUp, Plus, X } from "lucide-react";
import { useState } from "react";
import { services } from "../api/client";
import { plain, type PlainError } from "../api/errors";
import type { NodeTemplate } from "../gen/docent/v1/robot_services_pb";
import { words } from "../cawl/names";
import { Dialog } from "../ui/dialog";
import type { PaletteEntry } from "../flow/palette_data";

const largest = 10_000_000; // characters, as much as the server reads
const sources = [
  ["wsdl", "WSDL"],
  ["grpcTarget", "gRPC server"],
  ["adapter", "Robot's adapter"],
] as const;

export function ImportDialog(props: { onImported: (entries: PaletteEntry[]) => void; onClose: () => void }) {
  const [kind, setKind] = useState<(typeof sources)[number][0]>("wsdl");
  const [text, setText] = useState("");
  const [file, setFile] = useState<{ name: string; text: string } | null>(null);
  const [busy, setBusy] = useState(false);
  const [error, setError] = useState<PlainError | null>(null);
  const [templates, setTemplates] = useState<readonly NodeTemplate[] | null>(null);
  const ask = async () => {
    const value = (kind === "wsdl" ? (file?.text ?? text) : text).trim();
    if (value.length > largest)
      return setError({
        kind: "refused",
        title: "The file is too large",
        detail: "A WSDL may have 10 MB. Leave parts out that no step needs, such as documentation.",
      });
    setBusy(true);
    setError(null);
    try {
      const reply = await services.importTemplates({ from: { case: kind, value }, name: file?.name ?? kind });
      const wrong = reply.diagnostics.find((d) => !d.warning);
      if (wrong)
        setError({
          kind: "refused",
          title: wrong.message,
          detail: [wrong.line > 0 && `Line ${wrong.line}.`, wrong.hint].filter(Boolean).join(" "),
        });
      setTemplates(reply.templates);
    } catch (failure) {
      setError(plain(failure));
    }
    setBusy(false);
  };
  const take = () => {
    props.onImported(
      (templates ?? []).map((t) => ({
        kind: "operation",
        id: t.operation,
        title: words(t.operation),
        detail: t.service || t.endpoint,
        inputs: t.inputs.map((i) => ({ name: i.name, type: i.type })),
      })),
    );
    props.onClose();
  };
  const choose = () => {
    const input = document.createElement("input");
    input.type = "file";
    input.accept = ".wsdl,.xml";
    input.onchange = () =>
      void input.files?.[0]
        ?.text()
        .then((t) => (setFile({ name: input.files?.[0]?.name ?? "", text: t }), setError(null)));
    input.click();
  };
  return (
    <Dialog label="Import steps" width={560} onClose={props.onClose}>
      <div className="sheet-head">
        <h2 className="grow">Import steps</h2>
        <button className="button plain icon small" aria-label="Close" onClick={props.onClose}>
          <X size={15} />
        </button>
      </div>
      <div className="sheet-body" style={{ display: "grid", gap: "var(--space-5)" }}>
        <div className="segments" role="radiogroup" aria-label="From">
          {sources.map(([k, title]) => (
            <button
              key={k}
              role="radio"
              aria-checked={kind === k}
              onClick={() => (setKind(k), setTemplates(null), setError(null))}
            >
              {title}
            </button>
          ))}
        </div>
        {kind === "wsdl" ? (
          <>
            <div className="row">
              <button className="button" onClick={choose}>
                <FileUp size={14} />
                {file ? file.name : "Choose a file"}
              </button>
              <span className="faint small">or paste its text:</span>
            </div>
            {!file && (
              <textarea
                className="field mono"
                rows={6}
                value={text}
                placeholder="<definitions …>"
                aria-label="Text of the WSDL"
                onChange={(e) => setText(e.target.value)}
              />
            )}
          </>
        ) : (
          <input
            className="field"
            data-first
            placeholder="HOST:PORT"
            aria-label="Address"
            value={text}
            onChange={(e) => setText(e.target.value)}
            onKeyDown={(e) => e.key === "Enter" && void ask()}
          />
        )}
        {error && (
          <div className="notice bad" role="alert">
            <CircleAlert size={15} />
            <div>
              <b>{error.title}.</b> {error.detail}
            </div>
          </div>
        )}
        {templates && (
          <ul className="import-list" style={{ maxHeight: 200, overflow: "auto", display: "grid", gap: "var(--space-2)" }}>
            {templates.map((t) => (
              <li key={`${t.service} ${t.operation}`}>
                <b>{words(t.operation)}</b>{" "}
                <span className="faint small">
                  {[t.service, t.inputs.length > 0 && `takes ${t.inputs.map((i) => i.name).join(", ")}`]
                    .filter(Boolean)
                    .join(" · ")}
                </span>
              </li>
            ))}
            {templates.length === 0 && !error && <li className="faint">It offers no operation.</li>}
          </ul>
        )}
      </div>
      <div className="sheet-foot">
        <button className="button" onClick={props.onClose}>
          Cancel
        </button>
        {templates && templates.length > 0 ? (
          <button className="button primary" onClick={take}>
            <Plus size={14} />
            Add {templates.length} to the palette
          </button>
        ) : (
          <button
            className="button primary"
            disabled={busy || !(kind === "wsdl" ? (file?.text ?? text) : text).trim()}
            onClick={() => void ask()}
          >
            {busy ? "Reading" : "Read it"}
          </button>
        )}
      </div>
    </Dialog>
  );
}
