# SPDX-License-Identifier: AGPL-3.0-or-later
# OFF or OBJ to OBJ with smooth normals: turned about y, centred in x and z, and set on the floor y = 0.
#   awk -v name=N -v height=H [-v x=X] [-v z=Z] [-v turn=DEGREES] [-v lift=Y] [-v rainbow=1] -f place.awk MESH
# `rainbow` colours the points by their angle around the middle.
/^#/ || NF == 0 { next }
$1 == "OFF" { off = 1; next }
off && !counted { counted = 1; points = $1; next }
off && n < points { n++; px[n] = $1; py[n] = $2; pz[n] = $3; next }
off { face($2 + 1, $3 + 1, $4 + 1); next }
$1 == "v" { n++; px[n] = $2; py[n] = $3; pz[n] = $4 }
$1 == "f" { split($2, one, "/"); split($3, two, "/"); split($4, three, "/"); face(one[1], two[1], three[1]) }

function face(a, b, c) { m++; fa[m] = a; fb[m] = b; fc[m] = c }

# Adds the cross product of two edges to the three corners: triangles count by their area.
function add_normal(i, a, b, c,  ux, uy, uz, vx, vy, vz, k, p) {
  ux = px[b] - px[a]; uy = py[b] - py[a]; uz = pz[b] - pz[a]
  vx = px[c] - px[a]; vy = py[c] - py[a]; vz = pz[c] - pz[a]
  for (k = 0; k < 3; k++) {
    p = k == 0 ? a : k == 1 ? b : c
    nx[p] += uy * vz - uz * vy; ny[p] += uz * vx - ux * vz; nz[p] += ux * vy - uy * vx
  }
}

function wave(angle) { return 0.5 + 0.45 * cos(angle) }

END {
  pi = atan2(0, -1); s = sin(turn * pi / 180); k = cos(turn * pi / 180)
  for (i = 1; i <= n; i++) {
    t = k * px[i] + s * pz[i]; pz[i] = k * pz[i] - s * px[i]; px[i] = t
    if (i == 1 || px[i] < x0) x0 = px[i]
    if (i == 1 || px[i] > x1) x1 = px[i]
    if (i == 1 || py[i] < y0) y0 = py[i]
    if (i == 1 || py[i] > y1) y1 = py[i]
    if (i == 1 || pz[i] < z0) z0 = pz[i]
    if (i == 1 || pz[i] > z1) z1 = pz[i]
  }
  size = height / (y1 - y0)
  for (i = 1; i <= m; i++) add_normal(i, fa[i], fb[i], fc[i])
  print "o " name
  for (i = 1; i <= n; i++) {
    ax = px[i] - (x0 + x1) / 2; az = pz[i] - (z0 + z1) / 2
    angle = atan2(py[i] - (y0 + y1) / 2, ax)
    printf "v %.6f %.6f %.6f", size * ax + x, size * (py[i] - y0) + lift, size * az + z
    if (rainbow) printf " %.3f %.3f %.3f", wave(angle), wave(angle - 2.1), wave(angle + 2.1)
    print ""
  }
  for (i = 1; i <= n; i++) {
    l = sqrt(nx[i] ^ 2 + ny[i] ^ 2 + nz[i] ^ 2); if (l == 0) l = 1
    printf "vn %.5f %.5f %.5f\n", nx[i] / l, ny[i] / l, nz[i] / l
  }
  for (i = 1; i <= m; i++) printf "f %d//%d %d//%d %d//%d\n", fa[i], fa[i], fb[i], fb[i], fc[i], fc[i]
}
