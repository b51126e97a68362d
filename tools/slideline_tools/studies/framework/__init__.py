# SPDX-License-Identifier: MIT
"""What the sweeps of `tools/study.sh` share: jobs, the runner, the table, charts, rules of judgement, the pages."""
