// Service worker of the visitors' page: keeps its shell, so that it opens without a network. The build writes what it keeps
// into `version` and `files`. Calls of the API go to the network, always.
const cacheName = `visit-${version}`;
const patienceMs = 4000; // then the kept page is shown, and the network may come later

self.addEventListener("install", (event) => {
  event.waitUntil(
    caches
      .open(cacheName)
      .then((cache) => cache.addAll(files))
      .then(() => self.skipWaiting()),
  );
});
self.addEventListener("activate", (event) => {
  event.waitUntil(
    caches
      .keys()
      .then((names) =>
        Promise.all(
          names
            .filter((name) => name.startsWith("visit-") && name !== cacheName)
            .map((name) => caches.delete(name)),
        ),
      )
      .then(() => self.clients.claim()),
  );
});
self.addEventListener("fetch", (event) => {
  const url = new URL(event.request.url);
  if (event.request.method !== "GET" || url.origin !== location.origin) return;
  if (event.request.mode === "navigate") event.respondWith(page(event.request));
  else if (url.pathname.startsWith("/assets/") || files.includes(url.pathname))
    event.respondWith(asset(event.request));
});

// The newest page where the network is quick, else the kept one.
async function page(request) {
  const cache = await caches.open(cacheName);
  const kept = await cache.match("/visit");
  const fetched = fetch(request).then((answer) => {
    if (!answer.ok) throw new Error(`HTTP ${answer.status}`);
    return answer;
  });
  if (!kept) return fetched;
  const late = new Promise((resolve) => setTimeout(() => resolve(kept), patienceMs));
  return Promise.race([fetched, late]).catch(() => kept);
}

// Names of assets change with their content: what is kept stays good.
async function asset(request) {
  const cache = await caches.open(cacheName);
  const kept = await cache.match(request);
  if (kept) return kept;
  const answer = await fetch(request);
  if (answer.ok) await cache.put(request, answer.clone());
  return answer;
}
