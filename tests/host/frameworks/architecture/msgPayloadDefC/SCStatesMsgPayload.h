#pragma once
typedef struct {
  double r_BN_N[3];
  double v_BN_N[3];
  double sigma_BN[3];
  double omega_BN_B[3];
} SCStatesMsgPayload;
