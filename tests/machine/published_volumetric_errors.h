// The linear volumetric errors of the two papers, in the papers' own symbols: oracles.
#pragma once

#include <Eigen/Core>

namespace abbe::machine {

// Column machine with moving table: the error vector of the volumetric error lecture. d_ij: dx(x)
// is d[0][0], dy(x) d[1][0]; E likewise; X, Y, Z the machine, (Xp, Yp, Zp) the tool point.
struct LectureErrors {
  double d[3][3], E[3][3], alpha, beta1, beta2;
};

inline Eigen::Vector3d LectureColumn(const LectureErrors& e, double X, double Y, double Z,
                                     double Xp, double Yp, double Zp) {
  const auto& d = e.d;
  const double Exx = e.E[0][0], Exy = e.E[0][1], Exz = e.E[0][2];
  const double Eyx = e.E[1][0], Eyy = e.E[1][1], Eyz = e.E[1][2];
  const double Ezx = e.E[2][0], Ezy = e.E[2][1], Ezz = e.E[2][2];
  return {-d[0][0] - d[0][1] + d[0][2] - e.beta1 * Z - Z * (Eyx + Eyy) - Y * (Ezx + Ezy) +
              Yp * (Ezx + Ezy - Ezz) - Zp * (Eyx + Eyy - Eyz),
          -d[1][1] - d[1][0] + d[1][2] + e.alpha * X - e.beta2 * Z + Z * (Exx + Exy) + X * Ezx -
              Xp * (Ezx + Ezy - Ezz) + Zp * (Exx + Exy - Exz),
          d[2][2] - d[2][0] - d[2][1] - X * Eyx + Y * (Exx + Exy) + Xp * (Eyx + Eyy - Eyz) -
              Yp * (Exx + Exy - Exz)};
}

// Moving bridge: Ha and Khanh (2011), equations 19 to 21. xt[i] is x translation along i, xr[i]
// x rotation about i; the lacking term of equation 19 is added apart.
struct BridgeErrors {
  double xt[3], yt[3], zt[3], xr[3], yr[3], zr[3], xwy, zwx, zwy;
};

inline Eigen::Vector3d HaKhanhAsPrinted(const BridgeErrors& e, double X, double Z, double Xp,
                                        double Yp, double Zp) {
  const auto& [xt, yt, zt, xr, yr, zr, xwy, zwx, zwy] = e;
  return {xr[1] * (Z + Zp) - xt[0] - xr[2] * Yp - yr[2] * Yp + yr[1] * (Z + Zp) + yt[0] -
              zr[2] * Yp - zwx * Z + zt[0],
          -yt[1] + xr[2] * Xp + yr[2] * (X + Xp) + zr[2] * Xp - zr[0] * Zp - zwy * Z + zt[1] -
              xr[0] * (Z + Zp) - xwy * X + xt[1] - yr[0] * (Z + Zp),
          yt[2] - yr[1] * (X + Xp) + yr[0] * Yp - xr[1] * Xp + xr[0] * Yp - zr[1] * Xp +
              zr[0] * Yp - zt[2] + xt[2]};
}

}  // namespace abbe::machine
