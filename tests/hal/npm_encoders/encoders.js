// CANopen encoders (CiA 406) on the npm packages canopen and socketcan: an independent peer.
//
//   NODE_PATH=.../node_modules node encoders.js INTERFACE COUNTS_PER_TURN NODE...
//
// The same behaviour as can_encoders.py: each node beats every 50 ms, answers SDO reads, obeys NMT,
// and sends TPDO 1 at each SYNC: 1000 * node + 7 * the number of SYNCs since it was started, modulo
// the counts of a turn. Prints "ready" once it listens.
'use strict';
const { Device, DataType, NmtState } = require('canopen');
const can = require('socketcan');

const [interfaceName, perTurn, ...ids] = process.argv.slice(2);
const turn = Number(perTurn);
const SYNC = 0x080;

function makeEncoder(id, channel) {
  const device = new Device({ id });
  const number = (index, parameterName, value, dataType = DataType.UNSIGNED32) => {
    const entry = device.eds.addEntry(index, { parameterName, dataType });
    entry.value = value;
    return entry;
  };
  number(0x6000, 'operating parameters', 4, DataType.UNSIGNED16);
  number(0x6001, 'units per revolution', turn);
  number(0x6002, 'total range', turn);
  const position = number(0x6004, 'position value', 0);
  device.eds.setSyncCobId(SYNC);
  device.eds.setHeartbeatProducerTime(50);
  device.eds.addSdoServerParameter(id, 0x580 + id, 0x600 + id);
  device.eds.addTransmitPdo({ cobId: 0x180 + id, transmissionType: 1, dataObjects: [position] });
  let syncs = 0;
  device.on('message', (message) => channel.send(message));
  channel.addListener('onMessage', (message) => {
    if (message.id === SYNC && device.state === NmtState.OPERATIONAL) {
      syncs += 1;
      position.value = (1000 * id + 7 * syncs) % turn;
    }
    device.receive(message);
  });
  return device;
}

const channel = can.createRawChannel(interfaceName);
const encoders = ids.map((id) => makeEncoder(Number(id), channel));
channel.start();
for (const encoder of encoders) encoder.start();
console.log('ready');
