// Colour maps that grow lighter or darker evenly, so that they also work in grey and for eyes that do
// not tell red from green: 33 colours of matplotlib's each (CC0), mixed in between.

const MAPS = {
  viridis:
    "440154 470d60 48186a 482374 472d7b 453781 424086 3e4989 3b528b 375b8d 33638d 2f6b8e " +
    "2c728e 297a8e 26828e 23898e 21918c 1f988b 1fa088 22a785 28ae80 32b67a 3fbc73 4ec36b " +
    "5ec962 70cf57 84d44b 98d83e addc30 c2df23 d8e219 ece51b fde725",
  cividis:
    "00224e 00285b 002e6a 053371 1a386f 273e6e 32436d 3b496c 434e6c 4b546c 535a6d 5a5f6e " +
    "61656f 686a71 6f7073 767676 7d7c78 848279 8c8878 938e78 9b9476 a39a74 aba072 b4a76f " +
    "bcae6c c4b468 cdbb63 d5c25e dec958 e7d150 f0d846 f9e03a fee838",
  magma:
    "000004 030312 0a0822 130d34 1d1147 29115a 36106b 440f76 51127c 5d177f 6a1c81 762181 " +
    "832681 902a81 9c2e7f aa337d b73779 c43c75 d0416f dc4869 e75263 ef5d5e f56b5c f9795d " +
    "fc8961 fd9869 fea772 feb67c fec488 fed395 fde2a3 fcf0b2 fcfdbf",
  YlOrBr:
    "ffffe5 fffddb fffbd0 fff9c6 fff7bc fff2b1 feeda6 fee89b fee390 fedb80 fed36f fecb5f " +
    "fec34f feb945 feae3b fea332 fe9829 f98e23 f5841e f07919 eb6f14 e3660f db5d0b d35406 " +
    "cb4b02 be4503 b13f03 a43904 983404 8b3005 7e2c05 712806 662506",
};

const NOTHING = [0.76, 0.745, 0.71]; // where next to nothing has happened: rock, not a colour

// 256 colours of a map, as bytes; the lowest 2 % fade to the colour of rock.
function bytesOfMap(name) {
  const colors = MAPS[name].split(" ").map((c) => rgb("#" + c)), bytes = new Uint8Array(3 * 256);
  for (let k = 0; k < 256; k++) {
    const place = (k / 255) * (colors.length - 1);
    const first = Math.min(Math.floor(place), colors.length - 2);
    const part = Math.min(1, Math.max(0, (k / 255 - 0.004) / 0.018));
    const much = part * part * (3 - 2 * part);
    for (let i = 0; i < 3; i++) {
      const color = colors[first][i] + (colors[first + 1][i] - colors[first][i]) * (place - first);
      bytes[3 * k + i] = Math.round(255 * (NOTHING[i] + (color - NOTHING[i]) * much));
    }
  }
  return bytes;
}
