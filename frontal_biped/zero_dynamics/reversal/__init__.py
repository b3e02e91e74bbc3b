"""The reversal point beta_r-: bracket, scalar problem, solver, all zeros, certificate."""
