// A second viewer beside the page, which reads the service's messages directly. Runs in the browser, because Debian's
// Node has no WebSocket.

/** Opens a blank page of the service's origin that keeps the newest value of each channel. */
export async function watch(context, address) {
  const page = await context.newPage();
  await page.goto(`${address}/icon.svg`);
  await page.evaluate(() => {
    window.newest = {};
    const connect = () => {
      const socket = new WebSocket(`ws://${location.host}/ws`);
      socket.onopen = () =>
        socket.send(JSON.stringify({ op: "hello", channels: ["pose", "truth", "base", "navigator", "drive"] }));
      socket.onmessage = ({ data }) => {
        const message = JSON.parse(data);
        if (message.channel) window.newest[message.channel] = message.value;
      };
      socket.onclose = () => setTimeout(connect, 300); // the service is restarting
    };
    connect();
  });
  return { newest: (channel) => page.evaluate((name) => window.newest[name] ?? null, channel) };
}
