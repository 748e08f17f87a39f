// The sample drive of sample_log.h: which messages there are, and their bytes.
import { crc32 } from "@foxglove/crc";

export const TOPICS = [
  { topic: "/imu", type: "sensor_msgs/Imu", period: 1, begin: 0, size: 320 },
  { topic: "/cam0/image_raw", type: "sensor_msgs/Image", period: 5, begin: 0, size: 6000 },
  { topic: "/odom", type: "nav_msgs/Odometry", period: 2, begin: 0, size: 700 },
  { topic: "/fix", type: "sensor_msgs/NavSatFix", period: 10, begin: 100, size: 120 },
];
export const NUM_TICKS = 400;

export function payload(topic, tick) {
  const bytes = new Uint8Array(TOPICS[topic].size);
  const view = new DataView(bytes.buffer);
  view.setUint32(0, topic * 65536, true); // also the encapsulation header of CDR: zeros
  view.setUint32(4, tick, true);
  let random = topic * 65536 + tick + 1;
  for (let i = 8; i < bytes.length - 4; ++i) {
    random = (Math.imul(random, 1664525) + 1013904223) >>> 0;
    bytes[i] = i & 15 ? i >> 4 : random >>> 24; // most of it can be packed
  }
  view.setUint32(bytes.length - 4, crc32(bytes.subarray(0, bytes.length - 4)), true);
  return bytes;
}

export function* messages() {
  for (let tick = 0; tick < NUM_TICKS; ++tick)
    for (let topic = 0; topic < TOPICS.length; ++topic) {
      const { period, begin } = TOPICS[topic];
      if (tick < begin || tick % period !== 0) continue;
      const time = 1_700_000_000_000_000_000n + BigInt(tick) * 10_000_000n + BigInt(topic) * 1000n;
      yield { topic, tick, time, data: payload(topic, tick) };
    }
}
