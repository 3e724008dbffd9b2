// A run as a test of its workflow: kept by one touch, and tried with the document as it is now.
import { History, Star } from "lucide-react";
import { sentence } from "../api/errors";
import { usePoll } from "../api/poll";
import { Link } from "../ui/link";
import { paths } from "../ui/router";
import { dropTest, keepTest, listTests } from "../flow/run_tests";
import type { Run } from "../gen/docent/v1/workflows_pb";
import { toast } from "../ui/toasts";

export function RunTest({ run }: { run: Run }) {
  const tests = usePoll(`tests ${run.workflow}`, (signal) => listTests(run.workflow, signal), 5000);
  const kept = tests.data?.includes(run.id) ?? false;
  const keep = () =>
    (kept ? dropTest(run.id) : keepTest(run.workflow, run.id)).then(
      () => (
        tests.again(),
        toast(
          "good",
          kept ? "The test is dropped" : "The run is kept as a test",
          kept ? "" : `It is tried after each edit of ${run.workflow}.`,
        )
      ),
      (error: unknown) =>
        toast("bad", kept ? "The test could not be dropped" : "The run could not be kept", sentence(error)),
    );
  return (
    <>
      <button
        className="button plain icon"
        aria-pressed={kept}
        aria-label={kept ? "Drop the test" : "Keep as a test"}
        title={
          kept ? "A test: it is tried after each edit" : "Keep as a test, which is tried after each edit"
        }
        onClick={() => void keep()}
      >
        <Star size={15} fill={kept ? "currentColor" : "none"} />
      </button>
      <Link
        className="button plain wide-only"
        href={paths.trial(run.workflow, run.flow === run.workflow ? "" : run.flow, run.id)}
        title="See what this run would have done with the document as it is now, without robots"
      >
        <History size={14} />
        Try with changes
      </Link>
    </>
  );
}
