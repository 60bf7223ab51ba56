"""The arm in still water."""
