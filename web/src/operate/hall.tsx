export default function Hall(_: { picked: string }) { return <main className="view nothing"><p>Not yet.</p></main>; }
