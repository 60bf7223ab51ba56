#!/usr/bin/env bash
# Run a command, up to three times if it fails; the status is the last one's.
#   bash scripts/checks/retry.sh apt-get update
set -u
for pause in 10 30 0; do
  "$@" && exit 0
  status=$?
  echo "failed with status $status: $*" >&2
  sleep "$pause"
done
exit "$status"
