export default function Runs(_: { state: string; workflow: string }) { return <main className="view nothing"><p>Not yet.</p></main>; }
